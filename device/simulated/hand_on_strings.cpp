#include "device/simulated/hand_on_strings.h"

#include <cmath>

namespace frm::simulated {
namespace {

constexpr double longest_step = 1e-4;
constexpr double winding_speed = 3;  // m/s at which a motor takes up a string that nothing holds

}  // namespace

HandOnStrings::HandOnStrings(const Configuration& configuration) : configuration_(configuration) {
    spidar_g::string_rows(configuration_.geometry, pose_, rows_);
    first_ = out_ = rows_.length;
}

void HandOnStrings::place(const GripPose& pose) {
    pose_ = pose;
    twist_ = {};
    spidar_g::string_rows(configuration_.geometry, pose_, rows_);
    out_ = rows_.length;
}

void HandOnStrings::advance(double dt, const Tensions& tensions) {
    const int steps = static_cast<int>(std::ceil(dt / longest_step - 1e-9));
    for (int i = 0; i < steps; ++i) step(dt / steps, tensions);
}

void HandOnStrings::step(double dt, const Tensions& tensions) {
    const spidar_g::Hand& hand = configuration_.hand;
    // A turn by a small angle without a sine: (1 - k^2, 2k) / (1 + k^2), k the tangent of half of it.
    const double k = 3.14159265358979 * hand.frequency * dt, q = 1 + k * k;
    const double c = (1 - k * k) / q, s = 2 * k / q, was = cosine_;
    cosine_ = c * was - s * sine_;
    sine_ = s * was + c * sine_;

    Tensions pulling = tensions;
    if (faults.broken >= 0) pulling[static_cast<std::size_t>(faults.broken)] = 0;
    if (faults.slack >= 0) pulling[static_cast<std::size_t>(faults.slack)] = 0;
    const spidar_g::GripWrench w = spidar_g::wrench_of(rows_, pulling, configuration_.geometry.lever);
    const Vec3d lead = hand.centre + hand.cosine * cosine_ + hand.sine * sine_;
    const Quat<double> led = spidar_g::turned({}, hand.turning * sine_);
    const Vec3d force = w.force + (lead - pose_.position) * hand.stiffness - twist_.linear * hand.damping;
    const Vec3d torque = w.torque + spidar_g::rotation_between(pose_.rotation, led) * hand.turning_stiffness -
                         twist_.angular * hand.turning_damping;
    twist_.linear += force * (dt / hand.mass);
    twist_.angular += torque * (dt / hand.inertia);
    pose_.position += twist_.linear * dt;
    pose_.rotation = spidar_g::turned(pose_.rotation, twist_.angular * dt);
    spidar_g::string_rows(configuration_.geometry, pose_, rows_);

    for (std::size_t i = 0; i < spidar_g::string_count; ++i) {
        const int string = static_cast<int>(i);
        const double slack = string == faults.slack ? faults.slack_length : 0, way = winding_speed * dt;
        slack_[i] += std::fmin(std::fmax(slack - slack_[i], -way), way);
        if (string == faults.stuck) continue;
        if (string == faults.broken)
            out_[i] = std::fmax(0.0, out_[i] - (tensions[i] > 0 ? winding_speed * dt : 0));
        else
            out_[i] = rows_.length[i] + slack_[i];
    }
}

Counters HandOnStrings::counts() const {
    Counters out;
    for (std::size_t i = 0; i < spidar_g::string_count; ++i)
        out[i] =
            static_cast<std::int32_t>(std::floor((out_[i] - first_[i]) / configuration_.motors[i].metres_per_pulse));
    return out;
}

}  // namespace frm::simulated
