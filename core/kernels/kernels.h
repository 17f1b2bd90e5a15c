// The inner loops of a tick, each compiled for several instruction sets. The machine chooses one set when the program
// starts; all give the same bits, since every element's arithmetic is written out, sums have a fixed logical width and
// nothing is fused (docs/determinism.md).
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/kernels/lookup.h"
#include "core/kernels/wet_kernels.h"

namespace frm {

/// What the absorbing layer keeps at both ends of a row, in whole 64-byte vectors: 1 where the layer is not.
struct WaveDamp {
    const float *cells_left, *cells_right, *faces_left, *faces_right;
    std::ptrdiff_t left, right_at, right;  ///< floats, multiples of 16
};

/// Rows of cells of the wave field, from a column that is a multiple of 32 on. Pointers to that column of the first row,
/// 64-byte aligned, in arrays that are readable a vector (16 floats) to either side. Face i of velocity_x lies left of
/// cell i, row j of velocity_y below row j of cells.
struct WaveRows {
    float *height, *velocity_x, *velocity_y;
    std::ptrdiff_t stride;  ///< floats from row to row
    std::ptrdiff_t rows, count;
    bool with_faces;             ///< moves velocity_y too: one row ahead, at fourth order two
    bool wall_left, wall_right;  ///< face 0, face `count` is the border's: there u = -+ outflow h
    float outflow;
    const float* height_3;  ///< at fourth order, with one row: the row that stands for the third above
    const WaveDamp* damp;   ///< null: no layer. Of heights, velocity_x and those of velocity_y that no later row needs
    bool damp_left, damp_right;  ///< this row's part of the layer's ends
    std::ptrdiff_t first_column;
};

struct Kernels {
    const char* instructions;  ///< "baseline", "avx2" or "avx512"

    /// One step of rows, in their order: velocity_x -= f dh/dx, velocity_y -= f dh/dy, then height -= g times the
    /// divergence (Eqs. 7 and 8).
    void (*wave_rows)(const WaveRows& rows, float f, float g);
    /// The same at fourth order; f1, f3 are f times 27/24 and 1/24, and so g1, g3.
    void (*wave_rows_4)(const WaveRows& rows, float f1, float f3, float g1, float g3);
    /// v[i] -= f (h[i] - below[i]): faces across rows, alone.
    void (*wave_faces)(float* v, const float* h, const float* below, std::ptrdiff_t count, float f);
    void (*wave_faces_4)(float* v, const float* h, const float* below, const float* above, const float* below_2,
                         std::ptrdiff_t count, float f1, float f3);
    /// v[i] = factor h[i].
    void (*wave_outflow)(float* v, const float* h, std::ptrdiff_t count, float factor);
    /// u[i] += factor (p[i] - p[i - behind]).
    void (*wave_push)(float* u, const float* p, std::ptrdiff_t behind, std::ptrdiff_t count, float factor);
    /// The same for both velocities of a rectangle whose cells all have a neighbour to the left and below: rows of u and v
    /// are `stride` apart, rows of p `columns`.
    void (*wave_push_rows)(float* u, float* v, std::ptrdiff_t stride, const float* p, std::ptrdiff_t columns,
                           std::ptrdiff_t rows, std::ptrdiff_t count, float factor);
    /// Heights of a row later on: out[i] = h[i] - rise times the divergence + bend times the sum of the differences to the
    /// four neighbours. `v` and `v_above` are the faces below and above the row.
    void (*heights_ahead_row)(float* out, const float* h, const float* h_below, const float* h_above, const float* u,
                              const float* v, const float* v_above, std::ptrdiff_t count, float rise, float bend);
    /// Whether any |x| of rows is above the limit, or not a number.
    bool (*any_above)(const float* x, std::ptrdiff_t stride, std::ptrdiff_t rows, std::ptrdiff_t count, float limit);
    void (*scale)(float* x, std::ptrdiff_t count, float factor);
    /// The absorbing layer's ends of a row.
    void (*scale_ends)(float* x, const float* left, const float* right, const WaveDamp& damp);

    // wet_surface.inl
    void (*sample_heights)(const HeightGrid* grid, const GridPlacement* at, const float* x, const float* y,
                           const float* z, std::size_t count, float* out);
    void (*measure_clusters)(const ClusterBlock* block, const BodyLevel* level, const float* samples,
                             ClusterPlanes* planes, WetLanes* sum);
    std::uint32_t (*clip_triangles)(const TriangleBatch* batch, float offset, float ax, float ay, float az,
                                    WetLanes* sum, float* area);
    void (*height_range)(const float* h, std::ptrdiff_t stride, std::ptrdiff_t columns, std::ptrdiff_t rows,
                         float* least, float* most, float* odd);
    // footprint_rows.inl
    void (*slice_elements)(const ElementBlock* block, const SliceLevel* level, float depth, float ux, float uy,
                           float uz, float* laid, float* left);
    void (*refine)(float* fine, std::ptrdiff_t fine_stride, const float* coarse, std::ptrdiff_t stride,
                   std::ptrdiff_t rows, std::ptrdiff_t eights);
    void (*add_change_row)(float* h, const float* now, const float* before, std::ptrdiff_t count);
    float (*change_work)(float* h, std::ptrdiff_t stride, const float* now, const float* before, std::ptrdiff_t columns,
                         std::ptrdiff_t rows, std::ptrdiff_t count);
    float (*pressed_divergence)(const float* p, std::ptrdiff_t columns, const float* u, const float* v,
                                std::ptrdiff_t stride, std::ptrdiff_t rows, std::ptrdiff_t count);
    /// Eq. 6 for sources `first` to first + 15, and their forces added to `total`. Where `skip_friction` is set, the
    /// friction half of the forces and sums is left as it was.
    void (*look_up_block)(const LookupTable& map, const LookupMotion& motion, LookupBlock& block, std::size_t first,
                          LookupSum& total);
};

/// The best for this machine, unless use_kernels said otherwise.
const Kernels& kernels();

/// For tests: kernels() gives the set of this name from now on. False, and nothing changed, if this machine has none such.
bool use_kernels(const char* instructions);

/// All that this machine can run, the baseline first: for tests and benchmarks. Returns how many.
constexpr std::size_t max_kernel_sets = 3;
std::size_t every_kernel_set(const Kernels* (&sets)[max_kernel_sets]);

}  // namespace frm
