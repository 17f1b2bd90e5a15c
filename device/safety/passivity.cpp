#include "device/safety/passivity.h"

namespace frm::device {
namespace {

// Measured in closed loops of hand, device and waves from 100 Hz to 5 kHz (docs/haptic-stability.md).
constexpr float recovery_time = 0.5f;  ///< s: so fast the account goes back to its reserve by itself
constexpr float attack_time = 0.02f;   ///< s from the whole gain to the least
constexpr float release_time = 10;     ///< s back: slow, or the loop swings up again each time
constexpr float least_gain = 0.05f;

}  // namespace

void Passivity::observe(const Vec3f& force, const Vec3f& step, float dt, const PassivityLimits& limits) {
    if (!(dt > 0)) return;
    const Vec3f velocity = step / dt;
    if (!begun_) {
        slow_force_ = force;
        slow_velocity_ = velocity;
        energy_ = limits.reserve;
        begun_ = true;
    }
    const float share = dt / (limits.quick_time + dt);
    slow_force_ += (force - slow_force_) * share;
    slow_velocity_ += (velocity - slow_velocity_) * share;
    quick_velocity_ = velocity - slow_velocity_;
    energy_ -= dot(force - slow_force_, quick_velocity_) * dt;
    // An even trickle is the water's own unsteadiness, not a loop that swings itself up.
    energy_ += (limits.reserve - energy_) * (dt / (recovery_time + dt));
    if (energy_ > limits.reserve) energy_ = limits.reserve;
    if (energy_ < -limits.reserve) energy_ = -limits.reserve;
}

Vec3f Passivity::control(const Vec3f& force, float dt, const PassivityLimits& limits) {
    damping_ = 0;
    if (!(dt > 0)) return force;
    const float share = dt / (limits.quick_time + dt);
    slow_command_ += (force - slow_command_) * share;
    const bool active = energy_ < 0;
    gain_ += active ? -dt / attack_time * (1 - least_gain) : dt / release_time * (1 - least_gain);
    if (gain_ > 1) gain_ = 1;
    if (gain_ < least_gain) gain_ = least_gain;
    const Vec3f out = gain_ < 1 ? slow_command_ + (force - slow_command_) * gain_ : force;
    const float square = dot(quick_velocity_, quick_velocity_);
    if (!active || !(square > limits.dead_band * limits.dead_band)) return out;
    damping_ = -energy_ / (dt * square);
    if (damping_ > limits.max_damping) damping_ = limits.max_damping;
    return out - quick_velocity_ * damping_;
}

}  // namespace frm::device
