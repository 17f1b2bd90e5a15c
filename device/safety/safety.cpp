#include "device/safety/safety.h"

#include <algorithm>
#include <cstring>

#include "core/api/arguments.h"
#include "core/error.h"

namespace frm::device {
namespace {

Vec3f plain(const frm_vec3& v) { return {v.x, v.y, v.z}; }
frm_vec3 plain(const Vec3f& v) { return {v.x, v.y, v.z}; }

}  // namespace

frm_device_safety_def default_safety() {
    frm_device_safety_def def{};
    def.struct_size = sizeof def;
    def.passivity = 1;
    def.slew_time = 0.005f;
    def.ramp_time = 1;
    def.max_speed = 3;
    def.max_spin = 30;
    def.brake_time = 0.25f;
    def.grip_mass = 0.1f;
    def.grip_inertia = 5e-5f;
    def.energy_reserve = 0.005f;
    def.quick_time = 0.02f;
    def.dead_band = 0.005f;
    def.spin_dead_band = 0.05f;
    def.max_stale = 20;
    def.deadline_ns = 50'000'000;
    return def;
}

void require_safety(const frm_device_safety_def& d) {
    const auto number = [](float value, double low, double high, const char* name) {
        api::require_range(static_cast<double>(value), low, high, name);
    };
    if (d.passivity > 1) throw Error(FRM_ERROR_ARGUMENT, "def.passivity = %u is not 0 or 1", d.passivity);
    number(d.max_force, 0, 1e4, "def.max_force");
    number(d.max_torque, 0, 1e4, "def.max_torque");
    number(d.slew_time, 0, 1, "def.slew_time");
    number(d.ramp_time, 0, 60, "def.ramp_time");
    number(d.max_step, 0, 1e9, "def.max_step");
    number(d.max_speed, 0.01f, 1e3, "def.max_speed");
    number(d.max_spin, 0.01f, 1e4, "def.max_spin");
    number(d.brake_time, 0, 10, "def.brake_time");
    number(d.grip_mass, 1e-3f, 1e3, "def.grip_mass");
    number(d.grip_inertia, 1e-8f, 1e3, "def.grip_inertia");
    number(d.energy_reserve, 0, 1e3, "def.energy_reserve");
    number(d.quick_time, 1e-3f, 10, "def.quick_time");
    number(d.dead_band, 0, 1, "def.dead_band");
    number(d.spin_dead_band, 0, 10, "def.spin_dead_band");
    api::require_range(d.max_stale, 1, 1e6, "def.max_stale");
    number(d.dead_man_grip, 0, 1, "def.dead_man_grip");
    if (d.reserved != 0) throw Error(FRM_ERROR_ARGUMENT, "def.reserved is not 0");
    api::require_range(static_cast<double>(d.deadline_ns), 1e6, 1e10, "def.deadline_ns");
}

void Safety::engage(const Six& most) {
    if (engaged()) return;
    // A host may ask for less than the device has, never for more.
    const auto least = [](float asked, float own) { return asked > 0 ? std::min(asked, own) : own; };
    most_.linear.x = least(def_.max_force, most.linear.x);
    most_.angular.x = least(def_.max_torque, most.angular.x);
    phase_ = Phase::waiting;
    limited_ = damped_ = 0;
    restart();
}

void Safety::restart() {
    if (engaged()) phase_ = Phase::waiting;
    ramp_.reset();
    linear_.reset();
    angular_.reset();
    checks_.reset();
    has_state_ = false;
    braking_ = 0;
    stopped();
}

void Safety::disengage() {
    phase_ = Phase::off;
    ramp_.reset();
}

void Safety::stopped() { sent_ = base_ = displayed_ = {}; }

bool Safety::fault(std::uint32_t faults, const char* detail, double value) {
    if (!engaged() && !faulty()) return false;  // nothing is pushed: engaging will look again
    // What is latched already may grow, and has stopped the device before.
    const bool first = !faulty();
    latch_.set(faults, detail, value);
    if (!first) {
        if (faults != FRM_DEVICE_FAULT_SPEED) braking_ = 0;
        return false;
    }
    disengage();
    base_ = {};
    // A brake needs a state that can be believed.
    braking_ = faults == FRM_DEVICE_FAULT_SPEED && ready_ ? def_.brake_time : 0.0f;
    return !(braking_ > 0);
}

// Against the motion, in proportion to it; never more than the device's largest wrench, never so strong that a sampled
// damper makes energy itself.
Six Safety::brake() {
    if (!(braking_ > 0)) return {};
    braking_ -= dt_;
    bool limited = false;
    const float b = std::min(most_.linear.x / def_.max_speed, linear_limits().max_damping);
    const float spin_b = std::min(most_.angular.x / def_.max_spin, angular_limits().max_damping);
    return {shortened(velocity_.linear * -b, most_.linear.x, limited),
            shortened(velocity_.angular * -spin_b, most_.angular.x, limited)};
}

// A loop swings at a frequency that falls with its rate: what is quick is counted in cycles where they are long.
float Safety::quick_time() const { return std::max(def_.quick_time, 20 * cycle_); }

PassivityLimits Safety::linear_limits() const {
    return {def_.energy_reserve, quick_time(), def_.dead_band, cycle_ > 0 ? def_.grip_mass / (4 * cycle_) : 0.0f};
}

PassivityLimits Safety::angular_limits() const {
    return {def_.energy_reserve, quick_time(), def_.spin_dead_band,
            cycle_ > 0 ? def_.grip_inertia / (4 * cycle_) : 0.0f};
}

/// The commanded wrench behind gates and ramp.
Six Safety::wanted(const Six& command) {
    if (phase_ != Phase::on) return {};
    if (!held_) {
        ramp_.reset();
        return {};
    }
    ramp_.advance(dt_, def_.ramp_time);
    return {command.linear * ramp_.value(), command.angular * ramp_.value()};
}

Six Safety::limit(const Six& command, std::uint64_t deadline_ns) {
    deadline_ns_ = deadline_ns;
    if (was_asked_ && def_.max_step > 0 && phase_ == Phase::on) {
        const float leap = length(command.linear - asked_.linear), turn = length(command.angular - asked_.angular);
        const float most_turn = most_.linear.x > 0 ? def_.max_step * most_.angular.x / most_.linear.x : 0.0f;
        if (leap > def_.max_step)
            fault(FRM_DEVICE_FAULT_STEP, ", by %.4g N", static_cast<double>(leap));
        else if (most_turn > 0 && turn > most_turn)
            fault(FRM_DEVICE_FAULT_STEP, ", by %.4g N m", static_cast<double>(turn));
    }
    asked_ = command;
    was_asked_ = true;
    if (faulty()) return sent_ = brake();

    bool limited = false;
    const Six want = wanted(command);
    Six out{shortened(want.linear, most_.linear.x, limited), shortened(want.angular, most_.angular.x, limited)};
    const float share = def_.slew_time > 0 ? dt_ / def_.slew_time : 1.0f;
    out.linear = approached(base_.linear, out.linear, share * most_.linear.x, limited);
    out.angular = approached(base_.angular, out.angular, share * most_.angular.x, limited);
    base_ = out;
    if (phase_ == Phase::on) limited_ += limited;
    if (phase_ == Phase::on && def_.passivity) {
        out.linear = linear_.control(out.linear, dt_, linear_limits());
        out.angular = angular_.control(out.angular, dt_, angular_limits());
        damped_ += linear_.damping() > 0 || angular_.damping() > 0;
        out = {shortened(out.linear, most_.linear.x, limited), shortened(out.angular, most_.angular.x, limited)};
    }
    return sent_ = out;
}

bool Safety::observe(const frm_device_state& state) {
    const Motion motion = checks_.look(state, def_);
    dt_ = std::min(motion.dt, 0.1f);
    // The shortest cycle seen lately would be undone by one early answer; the mean is what damping is limited by.
    if (dt_ > 0) cycle_ = cycle_ > 0 ? cycle_ + (dt_ - cycle_) * 0.01f : dt_;
    velocity_ = {plain(state.twist.linear), plain(state.twist.angular)};
    held_ = (def_.dead_man_buttons == 0 || (state.buttons & def_.dead_man_buttons) != 0) &&
            state.grip >= def_.dead_man_grip;

    std::uint32_t faults = state.faults;
    if (state.status == FRM_DEVICE_UNCALIBRATED) faults |= FRM_DEVICE_FAULT_UNCALIBRATED;
    if (state.status >= FRM_DEVICE_FAULT && faults == 0) faults |= FRM_DEVICE_FAULT_DRIVER;
    // Before the first good state nothing was pushed that could have gone on for too long.
    if (phase_ == Phase::waiting) faults &= ~static_cast<std::uint32_t>(FRM_DEVICE_FAULT_DEADLINE);
    ready_ = faults == 0;
    faults |= motion.faults;
    if (has_state_ && engaged() && dt_ > 0 && static_cast<double>(motion.dt) > 1e-9 * static_cast<double>(deadline_ns_))
        faults |= FRM_DEVICE_FAULT_DEADLINE;
    if (motion.dt > 0) {
        // The force that the device displays from the last exchange on moved the grip to here.
        linear_.observe(displayed_.linear, motion.step.linear, motion.dt, linear_limits());
        angular_.observe(displayed_.angular, motion.step.angular, motion.dt, angular_limits());
    }
    displayed_ = {plain(state.achieved.force), plain(state.achieved.torque)};
    has_state_ = true;
    if (!faults) {
        if (phase_ == Phase::waiting) phase_ = Phase::on;
        return false;
    }
    if (faults == FRM_DEVICE_FAULT_SPEED) {
        if (motion.speed > def_.max_speed) return fault(faults, ", at %.3g m/s", static_cast<double>(motion.speed));
        return fault(faults, ", turning at %.3g rad/s", static_cast<double>(motion.spin));
    }
    return fault(faults);
}

void Safety::describe(frm_device_safety_state& out) const {
    out.engaged = phase_ == Phase::on ? 1u : phase_ == Phase::waiting ? 2u : 0u;
    out.faults = latch_.faults();
    out.ramp = phase_ == Phase::on ? ramp_.value() : 0.0f;
    out.sent = {plain(sent_.linear), plain(sent_.angular)};
    out.energy = linear_.energy();
    out.spin_energy = angular_.energy();
    out.damping = linear_.damping();
    out.spin_damping = angular_.damping();
    out.quick_gain = linear_.gain();
    out.quick_spin_gain = angular_.gain();
    out.limited = limited_;
    out.damped = damped_;
    out.fault_count = latch_.count();
    std::memcpy(out.reason, latch_.reason(), sizeof out.reason);
}

}  // namespace frm::device
