// Where a mesh is refused, a file that shows the place.
#pragma once

#include <string>

#include "bake/mesh/mesh_error.h"
#include "cli/command.h"

namespace frm::cli {

/// Writes bake::problem_glb() beside the output file `out`, or into the current folder where that is empty, as
/// NAME.problem.glb for a mesh NAME.glb. An older problem file is replaced; any other file is left alone and a number
/// is taken into the name. Returns what to add to the error: where the file is, or why there is none. Throws nothing.
std::string write_problem_file(const bake::MeshError& error, const std::string& mesh, const std::string& out);

/// What `load` returns. Where it refuses the shape of `mesh`, throws Failure with the refusal and the problem file.
template <typename Load>
auto load_or_show(const std::string& mesh, const std::string& out, Load load) -> decltype(load()) {
    try {
        return load();
    } catch (const bake::MeshError& error) {
        throw Failure(error.what() + write_problem_file(error, mesh, out));
    }
}

}  // namespace frm::cli
