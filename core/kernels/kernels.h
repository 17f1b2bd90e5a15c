// The inner loops of a tick, each compiled for several instruction sets. The machine chooses one set when the program
// starts; all give the same bits, since every element's arithmetic is written out, sums have a fixed logical width and
// nothing is fused (docs/determinism.md).
#pragma once

#include <cstddef>

namespace frm {

/// One row of cells of the wave field, from a column that is a multiple of 32 on: pointers to that column, 64-byte
/// aligned, of arrays that are readable a vector (16 floats) to either side. Face i lies left of cell i.
struct WaveRow {
    float* height;
    float* velocity_x;          ///< count + 1 faces
    const float* below;         ///< velocity_y between this row and the one below
    float* above;               ///< velocity_y between this row and the one above
    const float* height_above;  ///< null: `above` has been moved already
    std::ptrdiff_t count;
    float left, right;  ///< the velocity at a wall's face, and that of face `count`
    bool wall_left;     ///< face 0 is a wall's
};

/// The same at fourth order, which reaches one row further to each side.
struct WaveRow4 {
    float* height;
    float* velocity_x;
    const float* below;                           ///< velocity_y one row further below
    const float* velocity_y;                      ///< between this row and the one below
    const float* above;                           ///< between this row and the one above
    float* above_2;                               ///< one row further above
    const float *height_1, *height_2, *height_3;  ///< the rows above; height_3 null: `above_2` has been moved already
    std::ptrdiff_t count;
    float left, right;
    bool wall_left, wall_right;
};

/// What the absorbing layer keeps at both ends of a row, in whole 64-byte vectors: 1 where the layer is not.
struct WaveDamp {
    const float *cells_left, *cells_right, *faces_left, *faces_right;
    std::ptrdiff_t left, right_at, right;  ///< floats, multiples of 16
};

struct Kernels {
    const char* instructions;  ///< "baseline", "avx2" or "avx512"

    /// One step of a row and of the faces above it: velocity_x -= f dh/dx, above -= f dh/dy, then height -= g times the
    /// divergence (Eqs. 7 and 8).
    void (*wave_row)(const WaveRow& row, float f, float g);
    /// The same with velocity_x, above_2 and height; f1, f3 are f times 27/24 and 1/24, and so g1, g3.
    void (*wave_row_4)(const WaveRow4& row, float f1, float f3, float g1, float g3);
    /// v[i] -= f (h[i] - below[i]): faces across rows, alone.
    void (*wave_faces)(float* v, const float* h, const float* below, std::ptrdiff_t count, float f);
    void (*wave_faces_4)(float* v, const float* h, const float* below, const float* above, const float* below_2,
                         std::ptrdiff_t count, float f1, float f3);
    /// v[i] = factor h[i].
    void (*wave_outflow)(float* v, const float* h, std::ptrdiff_t count, float factor);
    /// u[i] += factor (p[i] - p[i - behind]).
    void (*wave_push)(float* u, const float* p, std::ptrdiff_t behind, std::ptrdiff_t count, float factor);
    void (*scale)(float* x, std::ptrdiff_t count, float factor);
    /// The columns of the absorbing layer in a row of heights, of velocity_x and of velocity_y; each may be null.
    void (*wave_damp)(float* h, float* u, float* v, const WaveDamp& damp);
};

/// The best for this machine; the same on every call.
const Kernels& kernels();

/// All that this machine can run, the baseline first: for tests and benchmarks. Returns how many.
constexpr std::size_t max_kernel_sets = 3;
std::size_t every_kernel_set(const Kernels* (&sets)[max_kernel_sets]);

}  // namespace frm
