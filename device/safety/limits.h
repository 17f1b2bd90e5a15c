// How much force, and how quickly it may change: ramp, magnitude, slew.
#pragma once

#include "core/math/vec.h"

namespace frm::device {

/// Force and torque, or linear and angular motion, in the host's axes. All rules of the safety layer use lengths and
/// scalar products alone, which are the same in any axes.
struct Six {
    Vec3f linear, angular;
};

/// Shortened to `most`; keeps its direction.
inline Vec3f shortened(const Vec3f& v, float most, bool& limited) {
    const float size = length(v);
    if (!(size > most)) return v;
    limited = true;
    return size > 0 ? v * (most / size) : Vec3f();
}

/// From `from` towards `to` by no more than `most`.
inline Vec3f approached(const Vec3f& from, const Vec3f& to, float most, bool& limited) {
    return from + shortened(to - from, most, limited);
}

/// 0 to 1 in `time` seconds, from zero again after each reset().
class Ramp {
public:
    void reset() { value_ = 0; }
    void advance(float dt, float time) {
        value_ = time > 0 ? value_ + dt / time : 1.0f;
        if (value_ > 1) value_ = 1;
    }
    float value() const { return value_; }

private:
    float value_ = 0;
};

}  // namespace frm::device
