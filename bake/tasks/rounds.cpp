#include "bake/tasks/rounds.h"

#include "bake/tasks/store.h"

namespace frm::bake {

std::vector<TaskResult> solve_rounds(BakePlan& plan, const RunSettings& settings, const RunProgress& progress,
                                     const ExtendPlan& extend) {
    std::vector<TaskResult> results;
    do {
        std::vector<std::size_t> missing;
        for (std::size_t k = results.size(); k < plan.tasks.size(); ++k) missing.push_back(k);
        results.resize(plan.tasks.size());
        run_tasks(plan.surface, plan.patches, plan.tasks, missing, settings, progress,
                  [&](std::size_t k, TaskResult&& result, bool) { results[k] = std::move(result); });
    } while (extend(plan, results));
    return results;
}

Found find_rounds(BakePlan& plan, Store& store, std::size_t known, const ExtendPlan& extend) {
    Found found;
    do {
        const std::size_t first = found.results.size();
        found.results.resize(plan.tasks.size());
        for (std::size_t k = first; k < plan.tasks.size(); ++k)
            if (!store.load(k, plan.tasks[k], found.results[k])) found.missing.push_back(k);
    } while (found.missing.empty() && extend(plan, found.results));
    found.extended = plan.tasks.size() > known;
    if (found.extended) store.set_tasks(plan);
    return found;
}

}  // namespace frm::bake
