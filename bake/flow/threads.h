// How many threads a run uses, and how they share rows of cells.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <vector>

#ifdef _OPENMP
#include <omp.h>
#endif

namespace frm::bake::flow {

inline int thread_count(int wanted) {
#ifdef _OPENMP
    return wanted > 0 ? wanted : omp_get_max_threads();
#else
    static_cast<void>(wanted);
    return 1;
#endif
}

inline std::size_t thread_number() {
#ifdef _OPENMP
    return static_cast<std::size_t>(omp_get_thread_num());
#else
    return 0;
#endif
}

/// Rows for a team of threads: each keeps to its own stretch, whose cells its core's cache holds from the step before,
/// and helps the others when it is done. With rows for whoever comes first, 64^3 cells took 2.7 times as long on two
/// quiet cores; with a stretch each and no help, all wait for the core that has other work.
class Shares {
public:
    Shares(std::size_t rows, int threads) : rows_(rows), next_(static_cast<std::size_t>(std::max(threads, 1))) {
        reset();
    }

    /// By one thread, between two uses.
    void reset() {
        for (std::size_t t = 0; t < next_.size(); ++t) next_[t].row.store(begin(t), std::memory_order_relaxed);
    }

    /// Calls `work(row)` for rows nobody has done yet; every thread of the team calls this.
    template <typename Work>
    void each(const Work& work) {
        const std::size_t self = thread_number() % next_.size();
        for (std::size_t n = 0; n < next_.size(); ++n) {
            const std::size_t owner = (self + n) % next_.size(), end = begin(owner + 1);
            for (;;) {
                const std::size_t first = next_[owner].row.fetch_add(lot, std::memory_order_relaxed);
                if (first >= end) break;
                for (std::size_t row = first; row < std::min(first + lot, end); ++row) work(row);
            }
        }
    }

private:
    static constexpr std::size_t lot = 16;
    struct alignas(64) Next {
        std::atomic<std::size_t> row{0};
    };

    std::size_t begin(std::size_t thread) const { return rows_ * thread / next_.size(); }

    std::size_t rows_;
    std::vector<Next> next_;
};

}  // namespace frm::bake::flow
