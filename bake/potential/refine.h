// Finer triangles where an error is large, without changing the shape.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/mesh/surface.h"

namespace frm::bake {

/// Halves the triangle with the largest `error` (one for each triangle, 0 or more) again and again, across the longest
/// side of it and its neighbours so that no angle gets much smaller (Rivara 1984), until there are `most_triangles`.
/// Each half is taken to have a quarter of the error. Every edge of `surface` must have exactly two triangles.
Surface refine(const Surface& surface, const std::vector<double>& error, std::size_t most_triangles);

}  // namespace frm::bake
