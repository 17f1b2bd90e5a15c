// How much of a shape is round: whether edges or boundary layers say where the water leaves it.
#pragma once

#include "bake/mesh/surface.h"

namespace frm::bake {

/// Share of the surface's turning (length of an edge times the angle between its triangles) that is in edges of less
/// than 30 degrees: 1 for a sphere of enough triangles, 0 for a box. The surface is one of repair().
double roundness(const Surface& surface);

}  // namespace frm::bake
