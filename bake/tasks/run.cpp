#include "bake/tasks/run.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

#include "bake/tasks/store.h"

namespace frm::bake {
namespace {

using Clock = std::chrono::steady_clock;

/// Between looks at what other processes do. A flow takes seconds to hours.
constexpr auto look_again = std::chrono::milliseconds(200);

class Work {
public:
    Work(const Surface& surface, const Regions& patches, const std::vector<Task>& tasks,
         const std::vector<std::size_t>& which, const RunSettings& settings, const RunProgress& progress,
         const TaskDone& done)
        : surface_(surface),
          patches_(patches),
          tasks_(tasks),
          which_(which),
          settings_(settings),
          progress_(progress),
          done_(done),
          items_(which.size()) {
        if (settings.part) {
            for (const std::size_t number : which) all_updates_ += tasks[number].cost.updates;
        } else {
            for (const Task& task : tasks) all_updates_ += task.cost.updates;
            finished_ = tasks.size() - which.size();
        }
        before_updates_ = all_updates_;
        for (const std::size_t number : which)
            if (!settings.store || !settings.store->has(number)) before_updates_ -= tasks[number].cost.updates;
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
    enum class Stage { open, busy, elsewhere, finished };
    struct Item {
        Stage stage = Stage::open;
        double share = 0;
    };
    static constexpr std::size_t none = static_cast<std::size_t>(-1);

    void work(int threads) {
        try {
            for (std::size_t i; !stop_.load() && next(i);) {
                if (i == none)
                    wait();
                else
                    take(i, threads);
            }
        } catch (...) {
            const std::lock_guard<std::mutex> lock(lock_);
            // The first failure is the cause; the others were stopped by it.
            if (!failure_) failure_ = std::current_exception();
            stop_ = true;
        }
    }

    /// The next item to try; none: others are at what is left. False if there is nothing more to do here.
    bool next(std::size_t& i) {
        const std::lock_guard<std::mutex> lock(lock_);
        bool left = false;
        for (i = 0; i < items_.size(); ++i) {
            if (items_[i].stage == Stage::open) {
                items_[i].stage = Stage::busy;
                return true;
            }
            left = left || items_[i].stage == Stage::elsewhere;
        }
        i = none;
        return left && settings_.wait;
    }

    void wait() {
        std::this_thread::sleep_for(look_again);
        const std::lock_guard<std::mutex> lock(lock_);
        RunState state;
        for (Item& item : items_) {
            if (item.stage != Stage::elsewhere) continue;
            ++state.waiting;
            item.stage = Stage::open;
        }
        // While another thread of ours solves, that one reports.
        if (std::none_of(items_.begin(), items_.end(), [](const Item& item) { return item.stage == Stage::busy; }) &&
            !tell(state))
            throw FlowCancelled("bake: cancelled");
    }

    void take(std::size_t i, int threads) {
        const std::size_t number = which_[i];
        const Task& task = tasks_[number];
        TaskResult result;
        const Store::Claim claim = settings_.store ? settings_.store->claim(number, task, result) : Store::Claim::ours;
        if (claim == Store::Claim::elsewhere) {
            const std::lock_guard<std::mutex> lock(lock_);
            items_[i].stage = Stage::elsewhere;
            return;
        }
        if (claim == Store::Claim::ours) {
            try {
                result = solve(i, threads);
                if (settings_.store) settings_.store->save(number, task, result);
            } catch (...) {
                if (settings_.store) settings_.store->give_back(number);
                throw;
            }
        }
        const std::lock_guard<std::mutex> lock(lock_);
        ++finished_;
        items_[i] = {Stage::finished, 1};
        done_(number, std::move(result), claim == Store::Claim::ours);
    }

    TaskResult solve(std::size_t i, int threads) {
        FlowCase flow = tasks_[which_[i]].flow;
        flow.threads = threads;
        TaskResult result =
            solve_flow(surface_, patches_, flow, [&](const FlowState& state) { return report(i, state); });
        if (result.ending == FlowEnding::cancelled) throw FlowCancelled("bake: cancelled");
        return result;
    }

    bool report(std::size_t i, const FlowState& flow) {
        const std::lock_guard<std::mutex> lock(lock_);
        if (stop_.load()) return false;
        items_[i].share = flow.share;
        RunState state;
        state.task = tasks_[which_[i]].name;
        state.recording = flow.recording;
        state.drag_coefficient = flow.drag_coefficient;
        state.statistics = flow.statistics;
        return tell(state);
    }

    bool tell(RunState& state) {
        if (!progress_) return true;
        double updates = all_updates_;
        for (std::size_t k = 0; k < items_.size(); ++k)
            updates -= (1 - items_[k].share) * tasks_[which_[k]].cost.updates;
        state.share = all_updates_ > 0 ? updates / all_updates_ : 1;
        state.done = finished_;
        state.all = settings_.part ? which_.size() : tasks_.size();
        // What was there when this began took no time of ours.
        const double elapsed = std::chrono::duration<double>(Clock::now() - begin_).count();
        const double worked = updates - before_updates_;
        if (elapsed > 1 && worked > 0) state.seconds_left = elapsed * (all_updates_ - updates) / worked;
        return progress_(state);
    }

    const Surface& surface_;
    const Regions& patches_;
    const std::vector<Task>& tasks_;
    const std::vector<std::size_t>& which_;
    const RunSettings& settings_;
    const RunProgress& progress_;
    const TaskDone& done_;
    const Clock::time_point begin_ = Clock::now();
    double all_updates_ = 0, before_updates_ = 0;
    std::atomic<bool> stop_{false};
    std::mutex lock_;
    std::vector<Item> items_;
    std::size_t finished_ = 0;
    std::exception_ptr failure_;
};

}  // namespace

std::string text_of(const RunState& state) {
    if (state.task.empty())
        return "waiting for " + std::to_string(state.waiting) + " of " + std::to_string(state.all) +
               " flows that another process is at";
    std::string text =
        "flow " + std::to_string(std::min(state.done + 1, state.all)) + "/" + std::to_string(state.all) + ": ";
    char number[64];
    std::snprintf(number, sizeof number, "drag %.2f", state.drag_coefficient);
    text += state.recording ? number : "starting";
    if (state.recording && state.statistics > 0) {
        std::snprintf(number, sizeof number, " +- %.1f %%", 100 * state.statistics);
        text += number;
    }
    return text + ", " + state.task;  // last: a narrow terminal cuts it off
}

void run_tasks(const Surface& surface, const Regions& patches, const std::vector<Task>& tasks,
               const std::vector<std::size_t>& which, const RunSettings& settings, const RunProgress& progress,
               const TaskDone& done) {
    if (which.empty()) return;
    const auto cores = static_cast<std::size_t>(settings.threads > 0 ? settings.threads : omp_get_max_threads());
    std::size_t fit = cores;
    for (const std::size_t number : which) {
        const Task& task = tasks[number];
        const std::uint64_t here = memory_limit_of(task.flow) / std::max<std::uint64_t>(1, task.cost.bytes);
        fit = std::min(fit, static_cast<std::size_t>(std::max<std::uint64_t>(1, here)));
    }
    const std::size_t workers = std::min({cores, which.size(), fit});
    Work(surface, patches, tasks, which, settings, progress, done)
        .run(workers, static_cast<int>(std::max<std::size_t>(1, cores / workers)));
}

}  // namespace frm::bake
