#include "bake/bake.h"

#include "bake/tasks/rounds.h"

namespace frm::bake {

std::unique_ptr<Map> bake(BakePlan& plan, const Progress& progress, BakeReport& report) {
    RunSettings settings;
    settings.threads = plan.options.threads;
    const RunProgress tell = [&](const RunState& state) { return !progress || progress(state.share, text_of(state)); };
    const std::vector<TaskResult> results = solve_rounds(plan, settings, tell);
    return make_map(plan, results, report);
}

}  // namespace frm::bake
