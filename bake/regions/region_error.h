// What it costs to take a region's wet part and velocity as one, measured on a body that turns half out of the water.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/mesh/surface.h"

namespace frm::bake {

/// Shares of the root mean square force and torque (see RegionJudge), from 0; the parts by themselves, which need not
/// add up to the whole.
struct RegionErrors {
    double whole = 0;
    double wet_ratio = 0;  ///< a region is wet everywhere to the same part; velocity exact
    double velocity = 0;   ///< a region moves everywhere as at its source; wetness exact
    double arm = 0;        ///< the force acts at the source; wetness and velocity exact
};

/// The reference is the finest that a map of this surface could be: each triangle a source. The other side is what a
/// tick does with regions (core/body/resistance.cpp): wet ratio times the region's force in a stream of the velocity at
/// its source. Both have the same law for the force on a triangle, that of formula_map() (bake/map/formula.h): pressed
/// by rho / 2 (u . n)^2 where the stream meets it, sucked at half of that at the lee. A map's own forces are not known
/// before it is solved; how wetness and velocity vary over a region does not hang on them.
///
/// The body is seen in 32 attitudes, with 20, 50 and 80 % of its surface under water in each (so that the blade of a
/// paddle is cut, and not its shaft alone), each with 4 motions (one if there are 10,000 triangles or more): a
/// translation, and a turning about its centroid that moves its farthest point as fast. Torque is about the centroid,
/// made a force by the root mean square radius of the surface. The error is the root of the mean square of the
/// difference, over that of the reference.
class RegionJudge {
public:
    /// Keeps a reference: the surface must outlive it.
    explicit RegionJudge(const Surface& surface);

    RegionErrors measure(const Regions& regions) const;

private:
    struct Facet {
        Vec3d centre, normal;  // from the centroid; normal's length is the area
        double inverse_area = 0;
    };
    struct Motion {
        Vec3d linear, angular;
    };
    struct Load {
        Vec3d force, torque;
    };

    template <typename Visit>
    void for_each_case(Visit visit) const;
    Load load_of(const Facet& facet, const Vec3d& velocity, const Vec3d& at) const;
    double squared(const Load& load) const;

    const Surface& surface_;
    Vec3d centre_;
    double area_ = 0, farthest_ = 0, radius_ = 0;
    std::vector<Facet> facets_;
};

}  // namespace frm::bake
