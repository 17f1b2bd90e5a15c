// The caller's floating-point modes are saved at every entry and given back: a host that flushes denormals or rounds
// down (any DSO linked with -ffast-math does) would otherwise change our bits, and we its. Threads have modes of their own.
#pragma once

#include <cstdint>

#if defined(__SSE2__) || defined(_M_X64)
#include <xmmintrin.h>
#endif

namespace frm {

class FloatingPointGuard {
public:
#if defined(__SSE2__) || defined(_M_X64)
    FloatingPointGuard() : saved_(_mm_getcsr()) {
        if (saved_ != standard) _mm_setcsr(standard);
    }
    ~FloatingPointGuard() {
        if (saved_ != standard) _mm_setcsr(saved_);
    }

private:
    static constexpr unsigned standard = 0x1F80;  // round to nearest, denormals kept, exceptions masked
    unsigned saved_;
#elif defined(__aarch64__)
    FloatingPointGuard() {
        asm volatile("mrs %0, fpcr" : "=r"(saved_));
        if (saved_ != 0) asm volatile("msr fpcr, %0" ::"r"(std::uint64_t{0}));
    }
    ~FloatingPointGuard() {
        if (saved_ != 0) asm volatile("msr fpcr, %0" ::"r"(saved_));
    }

private:
    std::uint64_t saved_;
#elif defined(__wasm__)
    // There are no modes.
    FloatingPointGuard() {}
    ~FloatingPointGuard() {}
#else
#error "which register holds this processor's floating-point modes?"
#endif

public:
    FloatingPointGuard(const FloatingPointGuard&) = delete;
    FloatingPointGuard& operator=(const FloatingPointGuard&) = delete;
};

}  // namespace frm
