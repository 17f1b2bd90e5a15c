// Time-domain passivity observer and controller (Hannaford and Ryu, "Time-domain passivity control of haptic interfaces",
// IEEE Trans. Robotics and Automation 18(1), 2002), for translation and rotation apart.
//
// The observer sums the energy that the displayed wrench took from the hand, E[n] = E[n-1] - f[n-1] . (x[n] - x[n-1]).
// An impedance that is passive never gives more than it has taken. Water does: it carries a paddle's weight, pushes with
// its waves and currents. So only the quick part counts, of force and motion both (each less its mean over quick_time):
// what a sampled loop makes of its own is at tens of hertz. And the account is bounded both ways: a reserve that an hour
// of strokes had filled would let a limit cycle go on for as long, and one overdrawn by a wave would damp for as long.
//
// The controller has two means. It takes the deficit back within one cycle, by damping -E / (dt v^2) of the quick motion:
// bounded, because a damper that is computed from a sampled velocity is itself unstable beyond about mass / dt, and with a
// dead band, because the quick velocity of a grip at rest is the encoders' last digit. That is the paper's, and enough for
// walls. The drag of water is itself a damper, 2 c |v| of it, and where it comes too late more damping comes too late as
// well. So the quick part of the force is weakened too, at once while the account is overdrawn, and comes back slowly;
// slow forces (weight, current, a stroke's mean drag) stay whole.
#pragma once

#include "core/math/vec.h"

namespace frm::device {

struct PassivityLimits {
    float reserve = 0;      ///< J
    float quick_time = 0;   ///< s
    float dead_band = 0;    ///< m/s or rad/s
    float max_damping = 0;  ///< N s/m or N m s/rad
};

class Passivity {
public:
    void reset() { *this = Passivity(); }
    /// `force` was displayed while the grip moved by `step` in `dt` seconds.
    void observe(const Vec3f& force, const Vec3f& step, float dt, const PassivityLimits& limits);
    /// What to display next instead of this force.
    Vec3f control(const Vec3f& force, float dt, const PassivityLimits& limits);

    float energy() const { return energy_; }
    float damping() const { return damping_; }
    float gain() const { return gain_; }

private:
    Vec3f slow_force_, slow_velocity_, quick_velocity_, slow_command_;
    float gain_ = 1, energy_ = 0, damping_ = 0;
    bool begun_ = false;
};

}  // namespace frm::device
