// The instruction set of the inner loops, for a scene that is linked with the core itself.
#include <cstdio>

#include "core/kernels/kernels.h"

extern "C" {
#include "tests/determinism/scene.h"
}

void list_instructions(void) {
    const frm::Kernels* sets[frm::max_kernel_sets];
    const std::size_t count = frm::every_kernel_set(sets);
    for (std::size_t i = 0; i < count; ++i) std::puts(sets[i]->instructions);
}

int use_instructions(const char* name) { return frm::use_kernels(name); }
