// Splits one shell into patches: clusters of triangles by position and normal, evened out in area.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/mesh/adjacency.h"

namespace frm::bake {

/// What the clustering knows of a triangle.
struct Facet {
    Vec3d centre;
    Vec3d normal;     ///< unit, or zero for a triangle without area
    double area = 0;  ///< m^2
};

Facet facet_of(const Surface& surface, std::size_t triangle);

/// The patch of each facet, 0 <= patch < count, none empty and all connected. All facets must be connected by
/// `neighbours`, and `count` be from 1 to their number.
std::vector<std::uint32_t> split_patches(const std::vector<Facet>& facets, const Neighbours& neighbours,
                                         std::uint32_t count);

}  // namespace frm::bake
