// How far a surface is from itself after a rotation or reflection about a point.
#pragma once

#include <cstddef>
#include <vector>

#include "bake/math/matrix.h"
#include "bake/mesh/surface.h"
#include "bake/mesh/tree.h"

namespace frm::bake {

/// Measures from sample points on the surface (its vertices, and points spread evenly over its area) to the nearest
/// triangle. Keeps a reference: the surface must outlive it.
class Deviation {
public:
    Deviation(const Surface& surface, const Vec3d& centre, std::size_t most_points);

    std::size_t points() const { return points_.size(); }

    /// The largest distance of g (point) from the surface over the first `points` sample points, m; infinite as soon as
    /// one is farther than `most`. One way round: the other way is that of the transpose of g.
    double worst(const Matrix3& g, double most, std::size_t points) const;

    /// Root of the mean squared distance over the first `points`, m; each counts `most` at the most.
    double mean(const Matrix3& g, double most, std::size_t points) const;

    /// Under a family of rotations: the largest distance of any point, and the largest over the vertices of what the
    /// twelfth part of the family that brings a vertex nearest comes to: a dent lies upon itself after a rotation about
    /// it, but not after so many. Both infinite if they come to more than `most`. A vertex at the distance `outer`
    /// from the centre is on the round shape by that: of a coarse sphere few rotations bring a corner to a corner.
    struct Family {
        double worst = 0, vertices = 0;
    };
    Family family(const std::vector<Matrix3>& rotations, const Family& most, std::size_t points, double outer) const;

private:
    struct Point {
        Vec3d at;  // from the centre
        bool vertex;
    };

    double squared(const Matrix3& g, const Point& point, double most_squared) const {
        return tree_.squared_distance(centre_ + g * point.at, most_squared);
    }

    Vec3d centre_;
    Tree tree_;
    std::vector<Point> points_;  // in an order in which any first part is spread over the surface
};

}  // namespace frm::bake
