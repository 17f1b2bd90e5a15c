// Joins vertices that coincide: exporters split them at every seam of normals and texture coordinates.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/mesh/surface.h"

namespace frm::bake {

/// For each vertex the first one, in the file's order, within `tolerance` metres of it (itself where there is none).
/// Deterministic. `tolerance` must be more than a millionth of the bounding box's largest side.
std::vector<std::uint32_t> weld_vertices(const std::vector<Vec3d>& vertices, double tolerance);

}  // namespace frm::bake
