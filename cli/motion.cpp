#include "cli/motion.h"

#include <cmath>

#include "cli/command.h"

namespace frm::cli {
namespace {

using Json = nlohmann::json;
constexpr double degree = 3.14159265358979323846 / 180;

Numbers numbers(const Json& j, const char* key, const std::string& where) {
    if (!j.contains(key)) return {0, 0, 0};
    const Json& v = j[key];
    if (!v.is_array() || v.size() != 3 || !v[0].is_number() || !v[1].is_number() || !v[2].is_number())
        throw Failure(where + "." + key + ": three numbers are needed");
    return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()};
}

std::array<double, 6> six(const Json& j, const std::string& where) {
    const Numbers p = numbers(j, "position", where), r = numbers(j, "rotation", where);
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

Motion::Motion(const Json& motion, const std::string& where) {
    if (!motion.is_object()) throw Failure(where + ": an object is needed");
    const std::string type = motion.value("type", "");
    for (const auto& [key, ignored] : motion.items()) {
        const bool known = key == "type" || (type == "device" && key == "device") || (type == "keyframes" && (key == "keys" || key == "repeat")) ||
                           ((type == "fixed" || type == "steady") && (key == "position" || key == "rotation")) ||
                           (type == "steady" && (key == "velocity" || key == "spin"));
        if (!known) throw Failure(where + "." + key + ": not known for the type \"" + type + "\"");
    }
    if (type == "fixed" || type == "steady") {
        keys_.push_back({0, six(motion, where)});
        const Numbers v = numbers(motion, "velocity", where), s = numbers(motion, "spin", where);
        velocity_ = {v[0], v[1], v[2], s[0] * degree, s[1] * degree, s[2] * degree};
    } else if (type == "keyframes") {
        if (!motion.contains("keys") || !motion["keys"].is_array() || motion["keys"].size() < 2)
            throw Failure(where + ".keys: at least two are needed");
        for (const Json& key : motion["keys"]) {
            const std::string here = where + ".keys[" + std::to_string(keys_.size()) + "]";
            if (!key.is_object() || !key.contains("time") || !key["time"].is_number()) throw Failure(here + ".time: a number is needed");
            keys_.push_back({key["time"].get<double>(), six(key, here)});
            if (keys_.size() > 1 && !(keys_.back().time > keys_[keys_.size() - 2].time))
                throw Failure(here + ".time: must be later than the one before");
        }
        repeat_ = motion.value("repeat", false);
    } else if (type == "device") {
        device_ = motion.value("device", "");
        if (device_.empty()) throw Failure(where + ".device: \"null\" or the path of a recording is needed");
    } else {
        throw Failure(where + ".type: \"" + type + "\" is not one of fixed, steady, keyframes, device");
    }
}

// A cubic through the keys whose slope at each is that of the line between its neighbours: position and velocity are continuous.
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
    pose.rotation = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)};
    twist.linear = {static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])};
    // Angular velocity of R = Rz Ry Rx: each angle's rate about its axis, carried along by the rotations after it.
    const double cy = std::cos(v[4]), sy = std::sin(v[4]), cz = std::cos(v[5]), sz = std::sin(v[5]);
    twist.angular = {static_cast<float>(cz * cy * d[3] - sz * d[4]), static_cast<float>(sz * cy * d[3] + cz * d[4]),
                     static_cast<float>(-sy * d[3] + d[5])};
}

}  // namespace frm::cli
