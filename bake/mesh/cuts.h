// Triangles that cut through each other.
#pragma once

#include <array>
#include <cstdint>

#include "bake/mesh/surface.h"

namespace frm::bake {

/// Whether an edge of one triangle passes through the inside of the other, farther than `margin` (m) from the other's
/// edges and with both ends farther than that from its plane. Triangles that only touch, or lie in one plane, do not
/// cut. Corners that both share are given as the same numbers.
bool triangles_cut(const std::vector<Vec3d>& vertices, const Triangle& a, const Triangle& b, double margin);

struct Cuts {
    std::size_t within = 0;       ///< pairs of triangles of one shell
    std::size_t between = 0;      ///< pairs of two shells
    Vec3d within_at, between_at;  ///< a corner of the first such triangle, m
    bool complete = true;         ///< false where the search was ended before its end; the numbers are then too low
};

/// Searches a closed surface; a margin of a millionth of its size. Ended after some 10 seconds' work on tangled shapes,
/// always at the same place. Not noticed: folds (triangles lying on their neighbours) and faces in one plane.
Cuts find_cuts(const Surface& surface);

}  // namespace frm::bake
