// What a tick leaves out where it does not count: each rule can be switched off, and with it on or off the answer agrees
// within a bound that the rule states.
#pragma once

#include <cstdint>

namespace frm {

enum Skip : std::uint32_t {
    skip_nothing = 0,
    skip_friction = 1,  ///< friction of a body whose friction is a negligible share of its pressure (core/map/tables.h)
    skip_steady = 2,    ///< fluctuations of sources that hardly fluctuate (core/map/tables.h)
    skip_default = 3
};

}  // namespace frm
