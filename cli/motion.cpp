#include "cli/motion.h"

#include <cmath>
#include <map>

namespace frm::cli {
namespace {

constexpr double degree = 3.14159265358979323846 / 180;

/// "position" and "rotation" of a motion or key.
std::array<double, 6> read_six(const JsonReader& j) {
    Numbers p{}, r{};
    j.read("position", p);
    j.read("rotation", r);
    return {p[0], p[1], p[2], r[0] * degree, r[1] * degree, r[2] * degree};
}

struct Quaternion {
    double x, y, z, w;
};

Quaternion product(const Quaternion& a, const Quaternion& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

}  // namespace

Motion::Motion(const JsonReader& j) {
    static const std::map<std::string, std::vector<std::string>> keys_of_type{
        {"fixed", {"type", "position", "rotation"}},
        {"steady", {"type", "position", "rotation", "velocity", "spin"}},
        {"keyframes", {"type", "keys", "repeat"}},
        {"device", {"type", "device"}}};
    std::string type;
    j.read("type", type);
    const auto known = keys_of_type.find(type);
    if (known == keys_of_type.end()) j.fail("type", "\"" + type + "\" is not one of fixed, steady, keyframes, device");
    j.allow_only(known->second, "the type \"" + type + "\"");

    if (type == "keyframes") {
        for (const JsonReader& key : j.list("keys")) {
            key.allow_only({"time", "position", "rotation"});
            if (!key.has("time")) key.fail("time", "a number is needed");
            Keyframe frame{0, read_six(key)};
            key.read("time", frame.time);
            if (!keys_.empty() && !(frame.time > keys_.back().time))
                key.fail("time", "must be later than the one before");
            keys_.push_back(frame);
        }
        if (keys_.size() < 2) j.fail("keys", "at least two are needed");
        j.read("repeat", repeat_);
    } else if (type == "device") {
        j.read("device", device_);
        if (device_.empty()) j.fail("device", "\"null\" or the path of a recording is needed");
    } else {
        keys_.push_back({0, read_six(j)});
        Numbers v{}, s{};
        j.read("velocity", v);
        j.read("spin", s);
        velocity_ = {v[0], v[1], v[2], s[0] * degree, s[1] * degree, s[2] * degree};
    }
}

// A cubic through the keys whose slope at each is that of the line between its neighbours: position and velocity are
// continuous.
std::array<double, 6> Motion::value(double time) const {
    if (keys_.size() == 1) {
        std::array<double, 6> v = keys_[0].value;
        for (std::size_t c = 0; c < 6; ++c) v[c] += velocity_[c] * time;
        return v;
    }
    const double first = keys_.front().time, last = keys_.back().time;
    if (repeat_ && time > first) time = first + std::fmod(time - first, last - first);
    if (time <= first) return keys_.front().value;
    if (time >= last) return keys_.back().value;
    std::size_t k = 0;
    while (time >= keys_[k + 1].time) ++k;
    const double width = keys_[k + 1].time - keys_[k].time, t = (time - keys_[k].time) / width;
    std::array<double, 6> out{};
    for (std::size_t c = 0; c < 6; ++c) {
        const auto slope = [&](std::size_t i) {
            if (i == 0 || i + 1 == keys_.size()) return 0.0;
            return (keys_[i + 1].value[c] - keys_[i - 1].value[c]) / (keys_[i + 1].time - keys_[i - 1].time);
        };
        const double a = keys_[k].value[c], b = keys_[k + 1].value[c], da = slope(k) * width, db = slope(k + 1) * width;
        out[c] = a + t * (da + t * (3 * (b - a) - 2 * da - db + t * (2 * (a - b) + da + db)));
    }
    return out;
}

std::array<double, 6> Motion::rate(double time) const {
    constexpr double h = 1e-4;
    const std::array<double, 6> before = value(time > h ? time - h : time), after = value(time + h);
    std::array<double, 6> out{};
    for (std::size_t c = 0; c < 6; ++c) out[c] = (after[c] - before[c]) / (time > h ? 2 * h : h);
    return out;
}

void Motion::at(double time, frm_pose& pose, frm_twist& twist) const {
    const std::array<double, 6> v = value(time), d = rate(time);
    const auto about = [](int axis, double angle) {
        Quaternion q{0, 0, 0, std::cos(angle / 2)};
        (axis == 0 ? q.x : axis == 1 ? q.y : q.z) = std::sin(angle / 2);
        return q;
    };
    const Quaternion qy = about(1, v[4]), qz = about(2, v[5]);
    const Quaternion q = product(qz, product(qy, about(0, v[3])));
    pose.position = {v[0], v[1], v[2]};
    pose.rotation = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z),
                     static_cast<float>(q.w)};
    twist.linear = {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])};
    // Angular velocity of R = Rz Ry Rx: each angle's rate about its axis, carried along by the rotations after it.
    const double cy = std::cos(v[4]), sy = std::sin(v[4]), cz = std::cos(v[5]), sz = std::sin(v[5]);
    twist.angular = {static_cast<float>(cz * cy * d[3] - sz * d[4]), static_cast<float>(sz * cy * d[3] + cz * d[4]),
                     static_cast<float>(-sy * d[3] + d[5])};
}

}  // namespace frm::cli
