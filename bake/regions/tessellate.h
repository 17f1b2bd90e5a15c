// Splits triangles until they are small enough to follow a water surface, without changing the shape.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/error.h"
#include "bake/mesh/surface.h"

namespace frm::bake {

struct Tessellation {
    Surface surface;
    std::vector<std::uint32_t> source;  ///< for each triangle the one it was cut from; never decreasing
    double longest_edge = 0;            ///< m; above what was asked for where `most_triangles` came first
};

/// Halves the longest edge of the whole surface, in both of its triangles, until none is longer than `longest_edge`
/// metres or the next cut would make more than `most_triangles`. No cracks or T-junctions arise, and no angle falls
/// below half of the smallest it came from. Every edge of `surface` must have exactly two triangles (see repair()).
Tessellation tessellate(const Surface& surface, double longest_edge, std::uint32_t most_triangles);

/// The triangles that a bake of the surface works on: no longer than a 24th of the bounding box's diagonal, so that a
/// tick sees the water rise along the body, and no more than `most_triangles` unless the surface has more.
Surface sample_triangles(const Surface& surface, std::uint32_t most_triangles = 2000);

}  // namespace frm::bake
