#include "bake/tasks/run.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

namespace frm::bake {
namespace {

class Work {
public:
    Work(const Surface& surface, const Regions& patches, const std::vector<Task>& tasks,
         const std::vector<std::size_t>& which, const Progress& progress,
         const std::function<void(std::size_t, TaskResult&&)>& done)
        : surface_(surface),
          patches_(patches),
          tasks_(tasks),
          which_(which),
          progress_(progress),
          done_(done),
          share_(which.size(), 0) {
        for (const std::size_t number : which) all_updates_ += tasks[number].cost.updates;
    }

    void run(std::size_t workers, int threads_each) {
        std::vector<std::thread> others;
        try {
            for (std::size_t i = 1; i < workers; ++i) others.emplace_back([&] { work(threads_each); });
        } catch (const std::system_error&) {
            // The system gives no more threads: those that there are do the work.
        }
        work(threads_each);
        for (std::thread& other : others) other.join();
        if (failure_) std::rethrow_exception(failure_);
    }

private:
    void work(int threads) {
        for (std::size_t i; !stop_.load() && (i = next_.fetch_add(1)) < which_.size();) {
            try {
                FlowCase flow = tasks_[which_[i]].flow;
                flow.threads = threads;
                TaskResult result = solve_flow(surface_, patches_, flow,
                                               [&](const FlowState& state) { return report(i, state); });
                if (result.ending == FlowEnding::cancelled) throw FlowCancelled("bake: cancelled");
                const std::lock_guard<std::mutex> lock(lock_);
                ++finished_;
                share_[i] = 1;
                done_(which_[i], std::move(result));
            } catch (...) {
                const std::lock_guard<std::mutex> lock(lock_);
                // The first failure is the cause; the others were stopped by it.
                if (!failure_) failure_ = std::current_exception();
                stop_ = true;
            }
        }
    }

    bool report(std::size_t i, const FlowState& state) {
        const std::lock_guard<std::mutex> lock(lock_);
        if (stop_.load()) return false;
        share_[i] = state.share;
        if (!progress_) return true;
        double updates = 0;
        for (std::size_t k = 0; k < which_.size(); ++k) updates += share_[k] * tasks_[which_[k]].cost.updates;
        char note[64];
        std::snprintf(note, sizeof note, state.recording ? "drag %.2f" : "starting", state.drag_coefficient);
        return progress_(updates / all_updates_,
                         std::to_string(finished_) + " of " + std::to_string(which_.size()) + " flows, " + note);
    }

    const Surface& surface_;
    const Regions& patches_;
    const std::vector<Task>& tasks_;
    const std::vector<std::size_t>& which_;
    const Progress& progress_;
    const std::function<void(std::size_t, TaskResult&&)>& done_;
    double all_updates_ = 0;
    std::atomic<std::size_t> next_{0};
    std::atomic<bool> stop_{false};
    std::mutex lock_;
    std::vector<double> share_;
    std::size_t finished_ = 0;
    std::exception_ptr failure_;
};

}  // namespace

void run_tasks(const Surface& surface, const Regions& patches, const std::vector<Task>& tasks,
               const std::vector<std::size_t>& which, int threads, const Progress& progress,
               const std::function<void(std::size_t, TaskResult&&)>& done) {
    if (which.empty()) return;
    const auto cores = static_cast<std::size_t>(threads > 0 ? threads : omp_get_max_threads());
    std::size_t fit = cores;
    for (const std::size_t number : which) {
        const Task& task = tasks[number];
        const std::uint64_t here = task.flow.memory_limit / std::max<std::uint64_t>(1, task.cost.bytes);
        fit = std::min(fit, static_cast<std::size_t>(std::max<std::uint64_t>(1, here)));
    }
    const std::size_t workers = std::min({cores, which.size(), fit});
    Work(surface, patches, tasks, which, progress, done)
        .run(workers, static_cast<int>(std::max<std::size_t>(1, cores / workers)));
}

}  // namespace frm::bake
