// All kernels, for one instruction set: included once by each file that is compiled for one, which defines
// FRM_KERNEL_SET, the set's name. Everything here lives in a namespace of that name and includes no header with inline
// functions: the linker would keep one copy of those, perhaps one that this machine cannot run.
#include <math.h>

#include <cstdint>
#include <cstring>

#include "core/kernels/kernels.h"
#if defined(__AVX2__)
#include <immintrin.h>
#endif

// Before a loop over lanes: no lane writes what another one reads.
#if defined(__clang__)
#define FRM_EACH_LANE _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define FRM_EACH_LANE _Pragma("GCC ivdep")
#else
#define FRM_EACH_LANE
#endif

namespace frm::FRM_KERNEL_SET {
#include "core/math/logarithm.h"  // a copy of its own, as frm::<set>::frm::logarithm

#include "core/kernels/eight.inl"
#include "core/kernels/footprint_rows.inl"
#include "core/kernels/lanes.inl"
#include "core/kernels/lookup.inl"
#include "core/kernels/wave_rows.inl"
#include "core/kernels/wet_surface.inl"

#define FRM_KERNEL_TEXT(name) #name
#define FRM_KERNEL_NAME(name) FRM_KERNEL_TEXT(name)

extern const Kernels kernels;
const Kernels kernels{
    FRM_KERNEL_NAME(FRM_KERNEL_SET),
    wave_rows,
    wave_rows_4,
    wave_faces,
    wave_faces_4,
    wave_outflow,
    wave_push,
    wave_push_rows,
    heights_ahead_row,
    any_above,
    scale,
    scale_ends,
    sample_heights,
    measure_clusters,
    clip_triangles,
    height_range,
    slice_elements,
    refine,
    add_change_row,
    change_work,
    pressed_divergence,
    look_up_block,
};
}  // namespace frm::FRM_KERNEL_SET
