#define FRM_KERNEL_SET avx512
#include "core/kernels/set.inl"
