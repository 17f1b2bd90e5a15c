// What a bake consists of: flows that know nothing of each other, so that they can be computed in any order, side by
// side or on other machines, and again where a result was lost.
#pragma once

#include <string>

#include "bake/flow/flow.h"

namespace frm::bake {

enum class TaskKind { stream, spin };

struct Task {
    std::string name;  ///< for people: "direction 12", "speed 2 direction 3", "spin -y"
    TaskKind kind = TaskKind::stream;
    FlowCase flow;  ///< `threads` is set by who runs it
    FlowPlan cost;  ///< what it takes: cell updates, memory

    bool is_stream(double speed) const { return kind == TaskKind::stream && flow.speed == speed; }
};

/// The forces on each patch of the plan. Its bits depend on the task, the surface and the patches alone.
using TaskResult = FlowSeries;

}  // namespace frm::bake
