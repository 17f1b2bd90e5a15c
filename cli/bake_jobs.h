// frm bake plan, solve and merge: a bake as independent jobs, for Slurm, MPI's launcher, or some machines with a disk
// in common.
#pragma once

#include "cli/command.h"

namespace frm::cli {

void add_bake_jobs(CLI::App& bake);

}  // namespace frm::cli
