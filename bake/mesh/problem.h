// A refused shape as a file to look at.
#pragma once

#include <string>

#include "bake/mesh/mesh_error.h"

namespace frm::bake {

/// Stored as the generator of problem files; tells them from files of the user.
inline constexpr const char* kProblemGenerator = "frm problem file";

/// The bytes of a .glb in the mesh's own frame: node "surface", the shape as the file has it, in translucent grey, and
/// node "problem", the marks as solid red bars, blocks and plates of at least 0.6 % of the size, so that they are seen
/// however small the place is. Of very many marks 20,000 are drawn, evenly chosen.
std::string problem_glb(const MeshError& error);

}  // namespace frm::bake
