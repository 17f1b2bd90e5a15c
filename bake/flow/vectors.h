// How loops over rows of cells become vector instructions: a row is one loop over contiguous floats, the compiler
// vectorises it for each instruction set below, and the machine picks at start-up. All of them give the same bits,
// because -ffp-contract=off keeps the fused instructions out.
#pragma once

#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__)
#define FRM_FLOW_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define FRM_FLOW_CLONES
#endif

/// Before a loop: what it stores is nothing that it reads later.
#if defined(__clang__)
#define FRM_FLOW_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define FRM_FLOW_INDEPENDENT _Pragma("GCC ivdep")
#else
#define FRM_FLOW_INDEPENDENT
#endif

/// Asks for memory that will be read soon: into the nearest cache, or only into the second (for long rows).
inline void ask_for(const float* memory) {
#if defined(__GNUC__)
    __builtin_prefetch(memory);
#else
    static_cast<void>(memory);
#endif
}
inline void ask_for_later(const float* memory) {
#if defined(__GNUC__)
    __builtin_prefetch(memory, 0, 2);
#else
    static_cast<void>(memory);
#endif
}
