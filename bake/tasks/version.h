// Which solver a result on disk is of.
#pragma once

namespace frm::bake {

/// Raise the number with every change after which a task could give other bits, or a plan other tasks: what is on disk
/// is then solved again instead of being mixed with what the new solver finds.
constexpr const char* solver_version = "frm flow 3";

}  // namespace frm::bake
