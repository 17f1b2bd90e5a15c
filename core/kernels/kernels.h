// The inner loops of a tick, each compiled for several instruction sets. The machine chooses one set when the program
// starts; all give the same bits, since every element's arithmetic is written out, sums have a fixed logical width and
// nothing is fused (docs/determinism.md).
#pragma once

#include <cstddef>

#include "core/kernels/lookup.h"

namespace frm {

struct Kernels {
    const char* instructions;  ///< "baseline", "avx2" or "avx512"

    /// u[i] -= factor * (h[i] - h[i - behind]) for i < count: Eq. 7 along a row of faces; `behind` is 1 along the row, a
    /// row's stride across it.
    void (*wave_velocity_row)(float* u, const float* h, std::ptrdiff_t behind, std::ptrdiff_t count, float factor);
    /// h[i] -= factor * ((u[i + 1] - u[i]) + (above[i] - below[i])) for i < count: Eq. 8 along a row of cells.
    void (*wave_height_row)(float* h, const float* u, const float* below, const float* above, std::ptrdiff_t count,
                            float factor);
    /// to[j stride + i] += factor * y[j] * x[i] for i < columns, j < rows.
    void (*add_product)(float* to, std::ptrdiff_t stride, const float* x, const float* y, std::ptrdiff_t columns,
                        std::ptrdiff_t rows, float factor);
    /// Eq. 6 for sources `first` to first + 15, and their forces added to `total`. Where `skip_friction` is set, the
    /// friction half of the forces and sums is left as it was.
    void (*look_up_block)(const LookupTable& map, const LookupMotion& motion, LookupBlock& block, std::size_t first,
                          LookupSum& total);
};

/// The best for this machine; the same on every call.
const Kernels& kernels();

/// All that this machine can run, the baseline first: for tests and benchmarks. Returns how many.
constexpr std::size_t max_kernel_sets = 3;
std::size_t every_kernel_set(const Kernels* (&sets)[max_kernel_sets]);

}  // namespace frm
