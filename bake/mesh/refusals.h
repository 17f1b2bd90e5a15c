// The refusals of repair(): what is said, and which places are marked.
#pragma once

#include <string>

#include "bake/mesh/adjacency.h"
#include "bake/mesh/mesh_error.h"

namespace frm::bake {

std::string count_of(std::size_t n, const char* thing);  ///< "1 hole", "2 holes"
std::string place(const Vec3d& p);                       ///< "(x, y, z) m", four digits

std::string length_text(double metres);  ///< "12.3 mm", from a metre on "1.23 m"

// Each throws MeshError: `name` is the file, `soup` the surface as it has it.

/// `what` ("the shape", "the piece near ...") consists of the triangles of `sheet`, which are marked.
[[noreturn]] void refuse_flat(const std::string& name, const std::string& what, const Surface& soup,
                              const Surface& sheet);
/// `triangles` (of vertices of soup) with an edge of one triangle, or of three, five ...; these edges are marked.
[[noreturn]] void refuse_open(const std::string& name, const Surface& soup, const std::vector<Triangle>& triangles,
                              double size);
/// All edges of four triangles or more are marked; `first` is the one that does not fall apart.
[[noreturn]] void refuse_crowded(const std::string& name, const Surface& soup, const std::vector<Triangle>& triangles,
                                 const HalfEdge& first);
/// `triangle` is where the winding fails.
[[noreturn]] void refuse_one_sided(const std::string& name, const Surface& soup, const Triangle& triangle);

}  // namespace frm::bake
