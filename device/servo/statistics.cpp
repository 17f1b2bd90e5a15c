#include "device/servo/statistics.h"

#include <algorithm>

namespace frm::device {

std::uint32_t Histogram::bin_of(std::uint64_t ns) {
    std::uint32_t low = 0, high = bins;
    while (high - low > 1) {
        const std::uint32_t middle = (low + high) / 2;
        (ns < edge(middle) ? high : low) = middle;
    }
    return low;
}

void Histogram::clear() {
    for (auto& count : counts_) count.store(0, std::memory_order_relaxed);
    largest_.store(0, std::memory_order_relaxed);
}

void Histogram::add(std::uint64_t ns) {
    auto& count = counts_[bin_of(ns)];
    count.store(count.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
    if (ns > largest()) largest_.store(ns, std::memory_order_relaxed);
}

std::uint64_t Histogram::quantile(double share) const {
    std::array<std::uint64_t, bins> counts;
    std::uint64_t all = 0;
    for (std::uint32_t i = 0; i < bins; ++i) all += counts[i] = count(i);
    if (all == 0) return 0;
    const double wanted = share * static_cast<double>(all);
    std::uint64_t sum = 0;
    for (std::uint32_t i = 0; i < bins; ++i) {
        sum += counts[i];
        if (static_cast<double>(sum) >= wanted && sum > 0)
            return std::min(i + 1 < bins ? edge(i + 1) : largest(), largest());
    }
    return largest();
}

}  // namespace frm::device
