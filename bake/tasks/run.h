// Solves tasks, several at a time: they are independent, so each core takes one whenever it is free.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bake/tasks/task.h"

namespace frm::bake {

class Store;

/// How the work stands.
struct RunState {
    double share = 0;             ///< of the cell updates of all tasks, 0 to 1
    double seconds_left = -1;     ///< by the cell updates done so far; negative: not known yet
    std::size_t done = 0;         ///< tasks
    std::size_t all = 0;          ///< tasks
    std::size_t waiting = 0;      ///< tasks that other processes are at, while nothing else is left to do here
    std::string task;             ///< the one that reports: "direction 12"; empty while waiting
    bool recording = false;       ///< false while its flow starts: no drag yet
    double drag_coefficient = 0;  ///< of it, running mean
    double statistics = 0;        ///< standard error of that as a share; 0 while not known
};
/// Called a few times a second, from any thread but never from two at once. False cancels (FlowCancelled).
using RunProgress = std::function<bool(const RunState&)>;

/// A task that is done: solved by this call, or found. From any thread, but never from two at once.
using TaskDone = std::function<void(std::size_t number, TaskResult&& result, bool solved)>;

struct RunSettings {
    int threads = 0;         ///< tasks at a time at most; 0: as many as there are cores
    Store* store = nullptr;  ///< keeps results, and divides the tasks between the processes that share it
    bool wait = true;        ///< for the results of other processes; else what they are at is left out
    bool part = false;       ///< progress is that of `which` alone; else the other tasks count as done
};

/// "flow 3/38, direction 12: drag 1.09 +- 2.1 %"
std::string text_of(const RunState& state);

/// Runs the tasks whose numbers `which` lists, in about that order, as many at a time as their `memory_limit` allows;
/// cores that are left over share a task. `done` is called once for each that was solved or found. Throws what a task
/// threw; the others are then stopped. Results that were saved stay.
void run_tasks(const Surface& surface, const Regions& patches, const std::vector<Task>& tasks,
               const std::vector<std::size_t>& which, const RunSettings& settings, const RunProgress& progress,
               const TaskDone& done);

}  // namespace frm::bake
