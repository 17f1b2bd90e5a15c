#define FRM_KERNEL_SET avx2
#include "core/kernels/set.inl"
