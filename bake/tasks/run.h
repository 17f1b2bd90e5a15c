// Solves tasks, several at a time: they are independent, so each core takes one whenever it is free.
#pragma once

#include <functional>
#include <vector>

#include "bake/tasks/task.h"

namespace frm::bake {

/// Runs the tasks whose numbers `which` lists, `threads` at a time (0: as many as there are cores) while their
/// `memory_limit` allows it; cores that are left over share a task. `done(number, result)` is called once for each, from
/// any thread but never from two at once; the order is not fixed. `progress` likewise. Throws what a task threw; the
/// others are then stopped.
void run_tasks(const Surface& surface, const Regions& patches, const std::vector<Task>& tasks,
               const std::vector<std::size_t>& which, int threads, const Progress& progress,
               const std::function<void(std::size_t, TaskResult&&)>& done);

}  // namespace frm::bake
