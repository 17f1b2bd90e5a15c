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

namespace frm::FRM_KERNEL_SET {
#include "core/math/logarithm.h"  // a copy of its own, as frm::<set>::frm::logarithm

#include "core/kernels/wave_rows.inl"
#include "core/kernels/product.inl"
#include "core/kernels/eight.inl"
#include "core/kernels/lookup.inl"

#define FRM_KERNEL_TEXT(name) #name
#define FRM_KERNEL_NAME(name) FRM_KERNEL_TEXT(name)

extern const Kernels kernels;
const Kernels kernels{
    FRM_KERNEL_NAME(FRM_KERNEL_SET),
    wave_velocity_row,
    wave_height_row,
    add_product,
    look_up_block,
};
}  // namespace frm::FRM_KERNEL_SET
