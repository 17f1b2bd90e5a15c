#include "bake/directions.h"

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

double updates_of(const FlowPlan& plan) { return plan.updates; }

class Work {
public:
    Work(const Surface& surface, const Regions& regions, const std::vector<FlowCase>& cases,
         const std::vector<FlowPlan>& plans, const Progress& progress,
         const std::function<void(std::size_t, const FlowSeries&)>& done)
        : surface_(surface),
          regions_(regions),
          cases_(cases),
          plans_(plans),
          progress_(progress),
          done_(done),
          share_(cases.size(), 0) {
        for (const FlowPlan& plan : plans) all_updates_ += updates_of(plan);
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
        for (std::size_t index; !stop_.load() && (index = next_.fetch_add(1)) < cases_.size();) {
            try {
                FlowCase flow_case = cases_[index];
                flow_case.threads = threads;
                const FlowSeries series =
                    solve_flow(surface_, regions_, flow_case,
                               [&](const FlowState& state) { return report(index, state); });
                if (series.ending == FlowEnding::cancelled) throw FlowCancelled("bake: cancelled");
                const std::lock_guard<std::mutex> lock(lock_);
                ++finished_;
                share_[index] = 1;
                done_(index, series);
            } catch (...) {
                const std::lock_guard<std::mutex> lock(lock_);
                // The first failure is the cause; the others were stopped by it.
                if (!failure_) failure_ = std::current_exception();
                stop_ = true;
            }
        }
    }

    bool report(std::size_t index, const FlowState& state) {
        const std::lock_guard<std::mutex> lock(lock_);
        if (stop_.load()) return false;
        share_[index] = state.share;
        if (!progress_) return true;
        double updates = 0;
        for (std::size_t i = 0; i < cases_.size(); ++i) updates += share_[i] * updates_of(plans_[i]);
        char note[64];
        std::snprintf(note, sizeof note, state.recording ? "drag %.2f" : "starting", state.drag_coefficient);
        return progress_(updates / all_updates_,
                         std::to_string(finished_) + " of " + std::to_string(cases_.size()) + " directions, " + note);
    }

    const Surface& surface_;
    const Regions& regions_;
    const std::vector<FlowCase>& cases_;
    const std::vector<FlowPlan>& plans_;
    const Progress& progress_;
    const std::function<void(std::size_t, const FlowSeries&)>& done_;
    double all_updates_ = 0;
    std::atomic<std::size_t> next_{0};
    std::atomic<bool> stop_{false};
    std::mutex lock_;
    std::vector<double> share_;
    std::size_t finished_ = 0;
    std::exception_ptr failure_;
};

}  // namespace

void solve_directions(const Surface& surface, const Regions& regions, const std::vector<FlowCase>& cases,
                      const std::vector<FlowPlan>& plans, int threads, std::uint64_t memory_limit,
                      const Progress& progress, const std::function<void(std::size_t, const FlowSeries&)>& done) {
    const auto cores = static_cast<std::size_t>(threads > 0 ? threads : omp_get_max_threads());
    std::uint64_t most_bytes = 1;
    for (const FlowPlan& plan : plans) most_bytes = std::max(most_bytes, plan.bytes);
    const auto fit = static_cast<std::size_t>(std::max<std::uint64_t>(1, memory_limit / most_bytes));
    const std::size_t workers = std::min({cores, cases.size(), fit});
    Work(surface, regions, cases, plans, progress, done)
        .run(workers, static_cast<int>(std::max<std::size_t>(1, cores / workers)));
}

}  // namespace frm::bake
