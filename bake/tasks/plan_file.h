// What a folder of tasks says about the bake that it belongs to, so that another process, another day or another
// machine comes to the same plan.
#pragma once

#include <cstddef>
#include <string>

#include "bake/bake.h"

namespace frm::bake {

struct PlanFile {
    BakeOptions options;      ///< `mesh` is the file's name alone, threads 0
    std::string fingerprint;  ///< of the plan that they gave
    std::size_t tasks = 0;    ///< of all rounds that were asked for so far
};

/// 16 hexadecimal digits of all that decides the map: the solver's version, the mesh as it was read, the options, the
/// tasks of the first round. To be called before extend_plan().
std::string fingerprint_of(const BakePlan& plan);

std::string plan_text(const BakePlan& plan, const std::string& fingerprint, std::size_t tasks);

/// Sound JSON, but not a plan of frm bake: not ours to write over.
bool is_somebody_elses(const std::string& text);

/// Throws BakeError, beginning with `name`, where the text is not a plan, or is of a version with other options.
PlanFile parse_plan(const std::string& text, const std::string& name);

}  // namespace frm::bake
