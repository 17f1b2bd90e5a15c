// A device that is not there in a hand that is not there either, for closed loops in simulated time: a grip with mass and
// inertia, held by springs and dampers at where the hand wants it to be; forces that come some cycles late; encoders that
// count; a velocity that is differenced and filtered. And every way in which a device can go wrong.
#pragma once

#include <array>
#include <atomic>
#include <cmath>
#include <functional>

#include "core/math/quat.h"
#include "frm.h"

namespace frm::test {

struct Hand {
    double mass = 0.3, damping = 5, stiffness = 300;                 ///< kg, N s/m, N/m; grip and hand together
    double inertia = 5e-4, spin_damping = 0.01, spin_stiffness = 1;  ///< kg m^2, N m s/rad, N m/rad
};

struct HandDeviceDef {
    double rate = 1000;
    Hand hand;
    std::uint32_t delay = 0;     ///< cycles before a force is displayed
    double quantum = 1.7e-5;     ///< m, of the pose; SPIDAR-G's count
    double spin_quantum = 7e-4;  ///< rad: that count at a lever of 22.5 mm
    double filter_time = 0.002;  ///< s, first order, of the velocity
    float max_force = 20, max_torque = 0.5f;
};

class HandDevice {
public:
    using Def = HandDeviceDef;

    explicit HandDevice(const Def& def) : def_(def) {}

    /// Where the hand wants the grip, by time.
    std::function<Vec3d(double)> target = [](double) { return Vec3d(); };
    std::function<Vec3d(double)> spin_target = [](double) { return Vec3d(); };  ///< a rotation vector

    // What goes wrong, from the next exchange on.
    std::uint32_t faults = 0, status = FRM_DEVICE_READY;
    frm_status answer = FRM_OK;
    bool frozen = false, bad_pose = false;
    std::uint64_t lost_ns = 0;  ///< added to the clock once
    Vec3d leap;                 ///< added to the pose

    // What is seen.
    frm_wrench told{};                    ///< none once it was stopped, perhaps by the watchdog
    frm_wrench commanded{};               ///< in the last exchange
    std::atomic<std::uint32_t> stops{0};  ///< the watchdog may count
    std::uint32_t calibrations = 0, exchanges = 0;
    std::uint32_t buttons = 0;
    float grip = 1;

    void hold(const Hand& hand) { def_.hand = hand; }

    double time() const { return static_cast<double>(cycles_) / def_.rate; }
    const Vec3d& position() const { return x_; }
    const Vec3d& velocity() const { return v_; }
    const Vec3d& spin() const { return w_; }
    const Vec3d& rotation() const { return r_; }
    void place_spin(const Vec3d& r, const Vec3d& w) { r_ = r, w_ = w, seen_spin_ = r, smooth_spin_ = w; }
    void place(const Vec3d& x, const Vec3d& v = {}) { x_ = x, v_ = v, seen_ = x, smooth_ = v; }

    static const frm_device_driver& driver() {
        static const frm_device_driver driver{sizeof driver, 0,         enumerate, open, close,
                                              info,          calibrate, exchange,  stop, nullptr};
        return driver;
    }

private:
    static HandDevice& self(void* instance) { return *static_cast<HandDevice*>(instance); }

    static frm_status FRM_CALL enumerate(void*, frm_device_info*, std::uint32_t, std::uint32_t* count) {
        *count = 1;
        return FRM_OK;
    }
    static frm_status FRM_CALL open(void* user, std::uint32_t, void** instance) {
        *instance = user;
        return FRM_OK;
    }
    static frm_status FRM_CALL close(void*, void*) { return FRM_OK; }
    static frm_status FRM_CALL info(void*, void* instance, frm_device_info* out) {
        out->max_force = self(instance).def_.max_force;
        out->max_torque = self(instance).def_.max_torque;
        out->period_ns = static_cast<std::uint64_t>(1e9 / self(instance).def_.rate);
        return FRM_OK;
    }
    static frm_status FRM_CALL calibrate(void*, void* instance) {
        ++self(instance).calibrations;
        return FRM_OK;
    }
    static frm_status FRM_CALL stop(void*, void* instance) {
        HandDevice& d = self(instance);
        d.told = {};
        d.line_ = {};
        ++d.stops;
        return FRM_OK;
    }
    static frm_status FRM_CALL exchange(void*, void* instance, const frm_device_command* command,
                                        frm_device_state* state) {
        return self(instance).cycle(command->wrench, *state);
    }

    frm_status cycle(const frm_wrench& wrench, frm_device_state& state) {
        ++exchanges;
        told = commanded = wrench;
        if (answer != FRM_OK) return answer;
        sense(state);
        for (std::size_t i = line_.size() - 1; i > 0; --i) line_[i] = line_[i - 1];
        line_[0] = wrench;
        move(line_[def_.delay]);
        state.achieved = line_[def_.delay];
        if (!frozen) ++cycles_;
        return FRM_OK;
    }

    static double rounded(double v, double quantum) { return quantum > 0 ? std::round(v / quantum) * quantum : v; }

    void sense(frm_device_state& state) {
        const double dt = 1 / def_.rate, share = dt / (def_.filter_time + dt);
        const auto quantised = [](const Vec3d& v, double q) {
            return Vec3d(rounded(v.x, q), rounded(v.y, q), rounded(v.z, q));
        };
        const Vec3d x = quantised(x_, def_.quantum), r = quantised(r_, def_.spin_quantum);
        smooth_ += ((x - seen_) / dt - smooth_) * share;
        smooth_spin_ += ((r - seen_spin_) / dt - smooth_spin_) * share;
        seen_ = x, seen_spin_ = r;
        const Vec3d shown = x + leap;
        state.pose.position = {bad_pose ? NAN : shown.x, shown.y, shown.z};
        // Rotations stay small here: a rotation vector and its quaternion.
        const double angle = length(r), half = angle > 1e-12 ? std::sin(angle / 2) / angle : 0.5;
        state.pose.rotation = {static_cast<float>(r.x * half), static_cast<float>(r.y * half),
                               static_cast<float>(r.z * half), static_cast<float>(std::cos(angle / 2))};
        state.twist.linear = {static_cast<float>(smooth_.x), static_cast<float>(smooth_.y),
                              static_cast<float>(smooth_.z)};
        state.twist.angular = {static_cast<float>(smooth_spin_.x), static_cast<float>(smooth_spin_.y),
                               static_cast<float>(smooth_spin_.z)};
        state.status = status;
        state.faults = faults;
        state.grip = grip;
        state.buttons = buttons;
        clock_extra_ += lost_ns;
        lost_ns = 0;
        state.time_ns = static_cast<std::uint64_t>(static_cast<double>(cycles_) * 1e9 / def_.rate) + clock_extra_;
        state.sequence = cycles_;
    }

    /// One cycle under a force that is held.
    void move(const frm_wrench& held) {
        constexpr double longest = 2.5e-5;
        const double dt = 1 / def_.rate;
        const int steps = static_cast<int>(std::ceil(dt / longest));
        const double h = dt / steps;
        const Vec3d force(held.force.x, held.force.y, held.force.z);
        const Vec3d torque(held.torque.x, held.torque.y, held.torque.z);
        const Hand& hand = def_.hand;
        for (int i = 0; i < steps; ++i) {
            const double t = time() + i * h;
            const Vec3d to = target(t), speed = (target(t + 1e-5) - target(t - 1e-5)) / 2e-5;
            const Vec3d turn = spin_target(t), spin = (spin_target(t + 1e-5) - spin_target(t - 1e-5)) / 2e-5;
            v_ += (force + (to - x_) * hand.stiffness + (speed - v_) * hand.damping) * (h / hand.mass);
            w_ += (torque + (turn - r_) * hand.spin_stiffness + (spin - w_) * hand.spin_damping) * (h / hand.inertia);
            x_ += v_ * h;
            r_ += w_ * h;
        }
    }

    Def def_;
    std::uint64_t cycles_ = 1, clock_extra_ = 0;
    Vec3d x_, v_, r_, w_, seen_, smooth_, seen_spin_, smooth_spin_;
    std::array<frm_wrench, 16> line_{};
};

}  // namespace frm::test
