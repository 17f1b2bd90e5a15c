// Rounds of tasks: what a round found may ask for more of them.
#pragma once

#include <functional>
#include <vector>

#include "bake/bake.h"
#include "bake/tasks/run.h"

namespace frm::bake {

using ExtendPlan = std::function<bool(BakePlan&, const std::vector<TaskResult>&)>;

/// Solves the plan's tasks, or finds them in `settings.store`, until `extend` asks for no more. The results, one a
/// task; the plan has all tasks then.
std::vector<TaskResult> solve_rounds(BakePlan& plan, const RunSettings& settings, const RunProgress& progress,
                                     const ExtendPlan& extend = extend_plan);

/// What a store has of the plan's tasks, round after round, without solving anything.
struct Found {
    std::vector<TaskResult> results;   ///< one a task; empty where there is none
    std::vector<std::size_t> missing;  ///< tasks; if there are none, the map can be made
    bool extended = false;             ///< all of a round was there and asked for tasks that the store did not count
};

/// Extends the plan as far as the results that are there allow, and writes the number of tasks down in the store.
/// `known` is the number of tasks that the store counted before.
Found find_rounds(BakePlan& plan, Store& store, std::size_t known, const ExtendPlan& extend = extend_plan);

}  // namespace frm::bake
