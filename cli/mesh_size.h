// Whether a mesh is as large as its file says, and what it is multiplied by if not.
#pragma once

#include <string>
#include <vector>

#include "bake/mesh/surface.h"
#include "cli/command.h"

namespace frm::cli {

/// --scale F.
void add_scale(CLI::App& command, double& scale);

/// For a command that does not ask: a note on a mesh that is not plausible in metres and that nobody scaled.
void note_size(const bake::SurfaceProperties& shape, double scale, std::vector<std::string>& notes);

/// Reads the mesh's size. One that is not plausible in metres gets a question on a terminal, whose answer may be a unit for
/// `scale`; else a Failure that says what to add to the command.
void settle_size(const std::string& mesh, double& scale);

}  // namespace frm::cli
