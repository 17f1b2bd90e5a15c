#define FRM_KERNEL_SET baseline
#include "core/kernels/set.inl"
