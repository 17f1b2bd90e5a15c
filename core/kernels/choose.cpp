#include <atomic>
#include <cstring>

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

namespace {

std::atomic<const Kernels*>& chosen() {
    static std::atomic<const Kernels*> set{[] {
        const Kernels* sets[max_kernel_sets];
        return sets[every_kernel_set(sets) - 1];
    }()};
    return set;
}

}  // namespace

const Kernels& kernels() { return *chosen().load(std::memory_order_relaxed); }

bool use_kernels(const char* instructions) {
    const Kernels* sets[max_kernel_sets];
    const std::size_t count = every_kernel_set(sets);
    for (std::size_t i = 0; i < count; ++i) {
        if (std::strcmp(sets[i]->instructions, instructions) != 0) continue;
        chosen().store(sets[i], std::memory_order_relaxed);
        return true;
    }
    return false;
}

}  // namespace frm
