// Where a direction is interpolated. Directions of the uniform stream sit on a subdivided octahedron: the points (i,
// j, k) / |.| for all integers with |i| + |j| + |k| = n, of which there are 4 n^2 + 2. Three of them and their weights
// are found without a search.
#pragma once

#include <array>
#include <cstdint>

#include "core/math/vec.h"

namespace frm {

struct DirectionWeights {
    std::uint32_t index[3];
    float weight[3];  ///< not negative; their sum is 1
    /// Whose corners the three are, in this order; any face where one weight is 1 and the direction the set's own.
    std::uint32_t face;
};

/// A direction by the face that it goes through and the weights of that face's corners.
struct FacePlace {
    std::uint32_t face;
    float weight[3];
};

struct Neighbours {
    std::uint32_t count = 0;
    std::uint32_t index[6];
};

/// A direction set of frequency n, 1 to 64. Order of the directions: i from -n to n, then j, then k, each ascending.
class DirectionSet {
public:
    static constexpr std::uint32_t max_frequency = 64;

    explicit DirectionSet(std::uint32_t frequency = 1) : n_(static_cast<std::int32_t>(frequency)) {}

    std::uint32_t frequency() const { return static_cast<std::uint32_t>(n_); }
    std::uint32_t count() const { return static_cast<std::uint32_t>(4 * n_ * n_ + 2); }
    /// Unit vector of a direction.
    Vec3d direction(std::uint32_t index) const;
    /// Barycentric weights in the octahedron's face, exact at the directions, continuous everywhere. `d` must not be
    /// zero; its length does not matter.
    DirectionWeights interpolate(const Vec3f& d) const;
    /// The same without the corners' numbers, for those who have a table of them. Zero and what is not finite give a face
    /// that there is.
    FacePlace locate(const Vec3f& d) const;

    /// Those of a direction's neighbours on the lattice that have a smaller index: points that differ from it by one in
    /// exactly two coordinates.
    Neighbours earlier_neighbours(std::uint32_t index) const;

    /// Triangles of neighbouring directions that cover the octahedron.
    std::uint32_t faces() const { return static_cast<std::uint32_t>(8 * n_ * n_); }
    std::array<std::uint32_t, 3> corners(std::uint32_t face) const;

private:
    std::array<std::int32_t, 3> point(std::uint32_t index) const;
    std::uint32_t index_of(std::int32_t i, std::int32_t j, std::int32_t k) const;

    std::int32_t n_;
};

}  // namespace frm
