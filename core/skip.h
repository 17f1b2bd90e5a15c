// What a tick leaves out where it does not count: frm_skip, bit for bit. Each rule can be switched off, and with it on or
// off the answer agrees within a bound that the rule states.
#pragma once

#include <cstdint>

namespace frm {

enum Skip : std::uint32_t {
    skip_nothing = 0,
    skip_friction = 1,
    skip_steady = 2,
    skip_dry_bodies = 4,
    skip_wet_bodies = 8,
    skip_calm_water = 16,
    skip_wave_steps = 32,
    skip_deep_bodies = 64,
    skip_still_bodies = 128,
    skip_default = 255
};

}  // namespace frm
