// Where a stress test's numbers come from, and how long it goes on: FRM_STRESS_SEED, FRM_STRESS_SECONDS, FRM_STRESS_TICKS.
#pragma once

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace frm::test {

inline std::uint64_t setting(const char* name, std::uint64_t otherwise) {
    const char* text = std::getenv(name);
    return text && *text ? std::strtoull(text, nullptr, 0) : otherwise;
}

inline std::uint64_t stress_seed() {
    static const std::uint64_t seed = setting("FRM_STRESS_SEED", 20061101);
    static const int printed = std::printf("stress: FRM_STRESS_SEED=%llu\n", static_cast<unsigned long long>(seed));
    (void)printed;
    return seed;
}

/// Splitmix64 (Steele, Lea and Flood 2014): the same numbers with every library.
class Random {
public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    double uniform(double low, double high) { return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53; }
    /// Evenly in the logarithm.
    double range(double low, double high) { return low * std::exp(uniform(0, std::log(high / low))); }
    std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(bits() % n); }
    bool once_in(std::uint32_t n) { return below(n) == 0; }

private:
    std::uint64_t state_;
};

/// A test takes the same seeds on every machine, and more of them until FRM_STRESS_SECONDS are over, where that is set.
class Turns {
public:
    explicit Turns(int seeds) : seeds_(seeds) {}
    bool more() {
        if (turns_++ < seeds_) return true;
        const std::chrono::duration<double> gone = std::chrono::steady_clock::now() - begin_;
        return gone.count() < static_cast<double>(setting("FRM_STRESS_SECONDS", 0));
    }

private:
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    int seeds_, turns_ = 0;
};

}  // namespace frm::test
