// What the states of a device tell about it: how far it went and how fast, and whether that can be. Only recorded numbers
// are used (the device's own clock too), so that a replay comes to the same.
#pragma once

#include <cstdint>

#include "core/math/quat.h"
#include "device/safety/limits.h"
#include "frm.h"

namespace frm::device {

/// From one state to the next.
struct Motion {
    float dt = 0;     ///< by the device's clock; 0 where the state is no news, or the first
    Six step;         ///< m, and the rotation vector (of small turns)
    float speed = 0;  ///< the larger of what the device says and what its poses say
    float spin = 0;
    std::uint32_t faults = 0;
};

class StateChecks {
public:
    void reset() { *this = StateChecks(); }
    Motion look(const frm_device_state& state, const frm_device_safety_def& def);

private:
    bool has_last_ = false;
    Vec3d position_;
    Quat<float> rotation_;
    std::uint64_t time_ = 0, sequence_ = 0;
    std::uint32_t stale_ = 0;
    Six velocity_;  ///< of the poses, smoothed
};

}  // namespace frm::device
