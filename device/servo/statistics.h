// How long ticks take and how late they begin: histograms that other threads read while they grow.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>

namespace frm::device {

/// Four bins an octave from 128 ns to 2 s: a quantile is known to a quarter of itself, with one increment a tick.
class Histogram {
public:
    static constexpr std::uint32_t bins = 96;

    static std::uint64_t edge(std::uint32_t bin) { return std::uint64_t{4 + bin % 4} << (5 + bin / 4); }
    static std::uint32_t bin_of(std::uint64_t ns);

    void clear();
    /// One thread at a time.
    void add(std::uint64_t ns);
    std::uint64_t count(std::uint32_t bin) const { return counts_[bin].load(std::memory_order_relaxed); }
    std::uint64_t largest() const { return largest_.load(std::memory_order_relaxed); }
    /// The upper edge of the bin in which this share of the values is reached; the largest value in the last that holds
    /// any. 0 without values.
    std::uint64_t quantile(double share) const;

private:
    std::array<std::atomic<std::uint64_t>, bins> counts_{};
    std::atomic<std::uint64_t> largest_{0};
};

/// A number that one thread counts and others read.
class Counter {
public:
    void clear() { value_.store(0, std::memory_order_relaxed); }
    void add(std::uint64_t n = 1) { value_.store(get() + n, std::memory_order_relaxed); }
    std::uint64_t get() const { return value_.load(std::memory_order_relaxed); }

private:
    std::atomic<std::uint64_t> value_{0};
};

}  // namespace frm::device
