// Tiny holes of a surface, closed; larger ones are the maker's to close.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/mesh/surface.h"

namespace frm::bake {

/// A hole is closed where its patch has at most this share of the surface's area: that of one cell of the flow's grid at
/// standard quality (16 cells across the root of the shadow, a quarter of the area), so that the water could not tell
/// the patch from the true surface ...
inline constexpr double kHoleArea = 0.001;
/// ... and its rim is at most this share of the size (the longest side of the bounding box) across, or it is a crack: no
/// wider on average than kCrackWidth of the size, a seam whose two sides have different vertices.
inline constexpr double kHoleExtent = 0.05;
inline constexpr double kCrackWidth = 1e-4;
/// All patches together, share of the area; a surface with more is in shreds and left as it is.
inline constexpr double kAllHolesArea = 0.01;

struct Holes {
    std::vector<Triangle> patches;  ///< turned as the triangles beside them
    std::size_t closed = 0, cracks = 0;
    double widest = 0;  ///< rim of a closed hole, the longest side of its bounding box, m
    Vec3d place;        ///< on the rim of the widest, m; of a crack where there is no hole
};

/// Patches the rims (closed chains of edges that have one triangle) within the limits above, with the triangles of least
/// area. A hole stays open when its patch would fold onto a neighbouring triangle, cut through the surface or need an
/// edge that is there already, and when its rim has more than 200 edges. `size` and `area` are those of the surface.
Holes close_holes(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& triangles, double size, double area);

/// The rims of a surface: chains of edges that have one triangle, each from vertex to vertex and back to its first.
/// Where rims meet in a vertex they are parted there. What is no closed chain is left out.
std::vector<std::vector<std::uint32_t>> find_rims(const std::vector<Triangle>& triangles);

/// Twice the area vector of a closed chain (Newell): its length is twice the area of a flat one.
Vec3d rim_area(const std::vector<Vec3d>& vertices, const std::vector<std::uint32_t>& rim);

/// Longest side of the chain's bounding box, m.
double rim_extent(const std::vector<Vec3d>& vertices, const std::vector<std::uint32_t>& rim);

}  // namespace frm::bake
