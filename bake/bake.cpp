#include "bake/bake.h"

#include "bake/tasks/run.h"

namespace frm::bake {

std::unique_ptr<Map> bake(BakePlan& plan, const Progress& progress, BakeReport& report) {
    std::vector<TaskResult> results;
    do {
        std::vector<std::size_t> missing;
        for (std::size_t k = results.size(); k < plan.tasks.size(); ++k) missing.push_back(k);
        results.resize(plan.tasks.size());
        run_tasks(plan.surface, plan.patches, plan.tasks, missing, plan.options.threads, progress,
                  [&](std::size_t k, TaskResult&& result) { results[k] = std::move(result); });
    } while (extend_plan(plan, results));
    return make_map(plan, results, report);
}

}  // namespace frm::bake
