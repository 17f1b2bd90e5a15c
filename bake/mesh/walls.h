// Inner walls: faces inside a shape that no water reaches, joined to its skin along edges of three triangles or more.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/mesh/surface.h"

namespace frm::bake {

/// The triangles that have water on one side: `triangles` without bulkheads, ribs and other faces of which both sides
/// lie inside, and without loose sheets wholly inside a closed piece. `triangles` itself where nothing can be told: the
/// shape is open, a sheet has water on both sides, faces lie in one another at an edge, or what would go is not inside
/// what would stay (an inner face that pokes out). Triangles keep their order.
std::vector<Triangle> without_inner_walls(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& triangles);

}  // namespace frm::bake
