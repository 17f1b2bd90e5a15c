// A closed loop in simulated time: hand, device, safety layer, servo's tick, map, water. And what of its motion is a
// limit cycle.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "device/servo/loop.h"
#include "tests/support/hand_device.h"
#include "tests/support/worlds.h"

namespace frm::test {

struct HapticCase {
    std::shared_ptr<const Map> map;
    double rate = 1000;
    HandDeviceDef device;
    bool passivity = true;
    float force_scale = 1, torque_scale = 0;
    double speed = 0.5;  ///< m/s along y: of the hand's wish
    double spin = 0;     ///< rad/s about z
    Vec3d start{0, 0, -0.3};
    float mass = 0;  ///< kg, of the body's weight
    double seconds = 2;
    std::int32_t cells = 120;  ///< of the water, 25 mm each
    /// Where the hand leads the grip by time, instead of straight on: a place, and a rotation vector.
    std::function<Vec3d(double)> path, turning;
    float grip_mass = 0.1f, grip_inertia = 5e-5f;  ///< what the safety layer is told of the grip; its defaults
};

struct HapticResult {
    double amplitude = 0;   ///< m (rad where the case spins), peak to peak, of the quick motion in the last half second
    double mean_force = 0;  ///< N, that the device displayed then, against the motion
    /// Peak to peak, of the quick motion in the half second that had most of it, along the axis that had most: m, rad.
    double worst = 0, worst_spin = 0;
    double mean_size = 0, mean_torque = 0;  ///< N and N m, of what was displayed, after the ramp
    double quick_gain = 1;
    std::uint64_t damped = 0;
    std::uint32_t faults = 0;
};

/// Peak to peak of what is left when the mean over `window` samples around each is taken off.
inline double quick_amplitude(const std::vector<double>& series, std::size_t window) {
    double low = 0, high = 0, sum = 0;
    if (series.size() <= 2 * window) return 0;
    for (std::size_t i = 0; i < window; ++i) sum += series[i];
    for (std::size_t i = window; i < series.size(); ++i) {
        const std::size_t middle = i - window / 2;
        sum += series[i] - series[i - window];
        // The window is even: its mean belongs between two samples, which a steady motion must not show.
        const double q = 0.5 * (series[middle] + series[middle + 1]) - sum / static_cast<double>(window);
        low = std::min(low, q), high = std::max(high, q);
    }
    return high - low;
}

/// The largest of quick_amplitude in half seconds, each a tenth of a second after the one before; the first half second,
/// in which forces ramp up, does not count.
inline double worst_amplitude(const std::vector<double>& series, double rate) {
    const auto window = static_cast<std::size_t>(0.1 * rate) / 2 * 2, span = static_cast<std::size_t>(0.5 * rate);
    double worst = 0;
    for (std::size_t at = span; at + span <= series.size(); at += span / 5) {
        const auto from = series.begin() + static_cast<std::ptrdiff_t>(at);
        worst = std::max(worst, quick_amplitude({from, from + static_cast<std::ptrdiff_t>(span)}, window));
    }
    return worst;
}

inline HapticResult run_haptic_case(HapticCase c) {
    c.device.rate = c.rate;
    HandDevice hand(c.device);
    hand.target = [&c](double t) { return c.start + Vec3d(0, c.speed * t, 0); };
    hand.spin_target = [&c](double t) { return Vec3d(0, 0, c.spin * t); };
    hand.place(c.start, {0, c.speed, 0});
    hand.place_spin({}, {0, 0, c.spin});
    if (c.path) hand.target = c.path, hand.place(c.path(0));
    if (c.turning) hand.spin_target = c.turning, hand.place_spin(c.turning(0), {});
    World world = world_of(WorldDef());
    world.create_water(water_of(c.cells, 0.025f, 0.8f));
    BodyDef held = body_of(c.map, c.start);
    held.mass = c.mass;
    Body& body = world.create_body(held);
    device::Device device(HandDevice::driver(), &hand, 0);
    frm_device_safety_def safety = device::default_safety();
    safety.passivity = c.passivity;
    safety.ramp_time = 0.3f;
    safety.deadline_ns = 10'000'000'000;
    safety.max_speed = safety.max_spin = 1000;  // what swings is to swing
    safety.grip_mass = c.grip_mass, safety.grip_inertia = c.grip_inertia;
    device.set_safety(safety);
    device.prepare();
    const api::Axes axes(FRM_AXES_Z_UP_RIGHT);
    device::ServoLoop loop(
        {axes, world, body, device, {{0, 0, 0}, {0, 0, 0, 1}}, static_cast<std::uint32_t>(c.rate), nullptr, nullptr});
    device::ServoRequests requests;
    requests.engage = true;
    requests.engaging = 1;
    requests.input.force_scale = c.force_scale;
    requests.input.torque_scale = c.torque_scale;
    const int ticks = static_cast<int>(c.seconds * c.rate), last = static_cast<int>(0.6 * c.rate);
    std::vector<double> series, place[3], turn[3];
    HapticResult result;
    for (int i = 0; i < ticks; ++i) {
        if (!loop.tick(requests)) break;
        for (int k = 0; k < 3; ++k) {
            place[k].push_back(hand.position()[k]);
            turn[k].push_back(hand.rotation()[k]);
        }
        if (i > ticks / 8) {
            const frm_wrench& w = loop.state().displayed;
            result.mean_size += static_cast<double>(length(Vec3f(w.force.x, w.force.y, w.force.z))) / (ticks * 7 / 8);
            result.mean_torque +=
                static_cast<double>(length(Vec3f(w.torque.x, w.torque.y, w.torque.z))) / (ticks * 7 / 8);
        }
        if (i < ticks - last) continue;
        series.push_back(c.spin != 0 ? hand.rotation().z : hand.position().y);
        result.mean_force -= static_cast<double>(loop.state().displayed.force.y) / last;
    }
    // Means over 0.1 s: 10 Hz and more are quick, 4 Hz by a half.
    result.amplitude = quick_amplitude(series, static_cast<std::size_t>(0.1 * c.rate) / 2 * 2);
    for (int k = 0; k < 3; ++k) {
        result.worst = std::max(result.worst, worst_amplitude(place[k], c.rate));
        result.worst_spin = std::max(result.worst_spin, worst_amplitude(turn[k], c.rate));
    }
    const frm_device_safety_state s = device.safety();
    result.quick_gain = static_cast<double>(c.spin != 0 ? s.quick_spin_gain : s.quick_gain);
    result.damped = s.damped;
    result.faults = s.faults;
    return result;
}

/// The same as no loop could do better: 5 kHz, no delay, exact encoders.
inline HapticCase ideal(HapticCase c) {
    c.rate = 5000;
    c.device.delay = 0;
    c.device.filter_time = 0;
    c.device.quantum = c.device.spin_quantum = 0;
    c.passivity = false;
    return c;
}

}  // namespace frm::test
