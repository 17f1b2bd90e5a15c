// Whether a mesh is as large as its file says, and what it is multiplied by if not.
#pragma once

#include <string>

#include "cli/command.h"

namespace frm::cli {

/// --scale F.
void add_scale(CLI::App& command, double& scale);

/// Of a mesh that is not plausible in metres, what a command that does not ask says of it; else nothing.
std::string note_on_size(double extent);

/// Reads the mesh's size. One that is not plausible in metres gets a question on a terminal, whose answer may be a unit for
/// `scale`; else a Failure that says what to add to the command.
void settle_size(const std::string& mesh, double& scale);

}  // namespace frm::cli
