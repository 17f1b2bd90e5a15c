#include "core/kernels/kernels.h"

namespace frm {

namespace baseline {
extern const Kernels kernels;
}
#ifdef FRM_KERNELS_X86
namespace avx2 {
extern const Kernels kernels;
}
namespace avx512 {
extern const Kernels kernels;
}
#endif

std::size_t every_kernel_set(const Kernels* (&sets)[max_kernel_sets]) {
    std::size_t count = 0;
    sets[count++] = &baseline::kernels;
#ifdef FRM_KERNELS_X86
    if (__builtin_cpu_supports("avx2")) sets[count++] = &avx2::kernels;
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq"))
        sets[count++] = &avx512::kernels;
#endif
    return count;
}

const Kernels& kernels() {
    static const Kernels& best = []() -> const Kernels& {
        const Kernels* sets[max_kernel_sets];
        return *sets[every_kernel_set(sets) - 1];
    }();
    return best;
}

}  // namespace frm
