// Which repairs of the paper's method are on: frm_model, bit for bit.
#pragma once

#include <cstdint>

namespace frm {

enum Model : std::uint32_t {
    model_paper = 0,
    model_displacement = 1,
    model_own_waves = 2,
    model_fluctuation = 4,
    model_speeds = 8,
    model_spin = 16,
    model_default = 31
};

}  // namespace frm
