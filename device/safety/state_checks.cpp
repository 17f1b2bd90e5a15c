#include "device/safety/state_checks.h"

#include <algorithm>

namespace frm::device {
namespace {

/// Poses are differentiated over some cycles: one count of an encoder is 17 mm/s at 1 kHz.
constexpr float velocity_time = 0.005f;

Vec3f plain(const frm_vec3& v) { return {v.x, v.y, v.z}; }

Quat<float> unit(const frm_quaternion& q) {
    const float size = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {q.x / size, q.y / size, q.z / size, q.w / size};
}

/// The rotation vector from a to b, in the frame that they turn into; right for small turns, too short for large ones.
Vec3f turn(const Quat<float>& a, const Quat<float>& b) {
    const Quat<float> d = b * conjugate(a);
    return Vec3f(d.x, d.y, d.z) * (d.w < 0 ? -2.0f : 2.0f);
}

}  // namespace

Motion StateChecks::look(const frm_device_state& state, const frm_device_safety_def& def) {
    Motion motion;
    const Vec3d position(state.pose.position.x, state.pose.position.y, state.pose.position.z);
    const Quat<float> rotation = unit(state.pose.rotation);
    motion.speed = length(plain(state.twist.linear));
    motion.spin = length(plain(state.twist.angular));
    if (has_last_) {
        if (state.time_ns < time_ || state.sequence < sequence_) motion.faults |= FRM_DEVICE_FAULT_STALE;
        stale_ = state.time_ns <= time_ || state.sequence <= sequence_ ? stale_ + 1 : 0;
        if (stale_ > def.max_stale) motion.faults |= FRM_DEVICE_FAULT_STALE;
        if (state.time_ns > time_) {
            motion.dt = static_cast<float>(static_cast<double>(state.time_ns - time_) * 1e-9);
            motion.step = {Vec3f(position - position_), turn(rotation_, rotation)};
            // Three times what is too fast already, and what a noisy encoder may do.
            if (!(length(motion.step.linear) <= 3 * def.max_speed * motion.dt + 0.005f) ||
                !(length(motion.step.angular) <= 3 * def.max_spin * motion.dt + 0.1f))
                motion.faults |= FRM_DEVICE_FAULT_JUMP;
            // A leap is no speed: it is said once, and by its name.
            const float share = motion.faults & FRM_DEVICE_FAULT_JUMP ? 0.0f : motion.dt / (velocity_time + motion.dt);
            velocity_.linear += (motion.step.linear / motion.dt - velocity_.linear) * share;
            velocity_.angular += (motion.step.angular / motion.dt - velocity_.angular) * share;
        }
        motion.speed = std::max(motion.speed, length(velocity_.linear));
        motion.spin = std::max(motion.spin, length(velocity_.angular));
    }
    has_last_ = true;
    position_ = position;
    rotation_ = rotation;
    time_ = state.time_ns;
    sequence_ = state.sequence;
    if (!(motion.speed <= def.max_speed) || !(motion.spin <= def.max_spin)) motion.faults |= FRM_DEVICE_FAULT_SPEED;
    return motion;
}

}  // namespace frm::device
