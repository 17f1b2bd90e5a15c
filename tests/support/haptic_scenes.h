// The scenes that the paper shows in a hand (Section 7.2, Figs. 1, 8, 9 and 10), as closed loops: where the hand leads. The
// paper gives the bodies, the grids and 500 Hz; its motions are in films only, so these are like them. The canoe's paddle
// moves as in samples/paddle_stroke.json.
#pragma once

#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/haptic_loop.h"

namespace frm::test {

constexpr double pi = 3.14159265358979323846;

/// A closed path through the keys of a scene's first body (docs/scene.md): cubic, slopes of the neighbours' line.
class KeyframePath {
public:
    explicit KeyframePath(const std::string& scene) {
        const auto json = nlohmann::json::parse(std::ifstream(scene));
        for (const auto& key : json.at("bodies").at(0).at("motion").at("keys")) {
            std::array<double, 7> k{};
            k[6] = key.at("time");
            for (std::size_t c = 0; c < 3; ++c) {
                k[c] = key.at("position").at(c);
                k[c + 3] = key.at("rotation").at(c).get<double>() * pi / 180;
            }
            keys_.push_back(k);
        }
        if (keys_.size() < 2) throw std::runtime_error(scene + " has no keyframes");
    }

    Vec3d place(double t) const { return at(t, 0); }
    /// Its three angles taken for a rotation vector: a hand that turns about one axis at a time mostly.
    Vec3d turn(double t) const { return at(t, 3); }
    double seconds() const { return keys_.back()[6]; }

private:
    Vec3d at(double t, std::size_t first) const {
        t = std::fmod(std::max(t, 0.0), seconds());
        std::size_t k = 0;
        while (t >= keys_[k + 1][6]) ++k;
        const double width = keys_[k + 1][6] - keys_[k][6], u = (t - keys_[k][6]) / width;
        Vec3d out;
        for (std::size_t c = 0; c < 3; ++c) {
            const auto slope = [&](std::size_t i) {
                if (i == 0 || i + 1 == keys_.size()) return 0.0;
                return width * (keys_[i + 1][first + c] - keys_[i - 1][first + c]) /
                       (keys_[i + 1][6] - keys_[i - 1][6]);
            };
            const double a = keys_[k][first + c], b = keys_[k + 1][first + c], da = slope(k), db = slope(k + 1);
            out[static_cast<int>(c)] = a + u * (da + u * (3 * (b - a) - 2 * da - db + u * (2 * (a - b) + da + db)));
        }
        return out;
    }

    std::vector<std::array<double, 7>> keys_;
};

/// A hand, and what a host tells the safety layer of its grip.
struct NamedHand {
    const char* name;
    Hand hand;
    float grip_mass = 0.1f, grip_inertia = 5e-5f;
};

/// The two hands of the chart, on a SPIDAR-G's ball; and one on a stick that hangs in a frame as large as a room, as the
/// paper's paddle and rod do.
constexpr NamedHand light_hand{"light", {0.1, 1, 50, 2e-4, 2e-3, 0.2}};
constexpr NamedHand firm_hand{"firm", {0.3, 8, 400, 5e-4, 0.02, 2}};
constexpr NamedHand stick_hand{"stick", {0.5, 8, 400, 0.05, 0.3, 20}, 0.5f, 0.05f};

struct PaperScene {
    std::string name;
    HapticCase haptic;
};

/// At 500 Hz. Maps by name: sphere, plate, lure, paddle.
inline std::vector<PaperScene> paper_scenes(const std::map<std::string, std::shared_ptr<const Map>>& maps,
                                            const std::string& paddle_scene) {
    const auto scene = [&maps](const char* name, const char* map, double seconds, std::int32_t cells) {
        PaperScene s{name, {}};
        s.haptic.map = maps.at(map);
        s.haptic.rate = 500;
        s.haptic.seconds = seconds;
        s.haptic.cells = cells;
        s.haptic.device.delay = 1;
        s.haptic.device.max_force = 200, s.haptic.device.max_torque = 40;  // nothing is cut off
        s.haptic.torque_scale = 1;
        s.haptic.turning = [](double) { return Vec3d(); };
        return s;
    };
    std::vector<PaperScene> out;
    // Fig. 8: a sphere of 5 cm, clockwise in a circle, most of it under water.
    out.push_back(scene("sphere, circle", "sphere", 4, 128));
    out.back().haptic.path = [](double t) {
        const double w = 2 * pi / 1.9;
        return Vec3d(0.15 * std::cos(w * t), -0.15 * std::sin(w * t), -0.02);
    };
    // Fig. 9: a parallelepiped of 8 x 1 x 30 cm, upright, face ahead.
    out.push_back(scene("parallelepiped, ahead", "plate", 3, 128));
    out.back().haptic.path = [](double t) { return Vec3d(0, -0.6 + 0.4 * t, -0.1); };
    // Fig. 10: a lure, drawn in with twitches. (Its map is of a box of 2 x 8 x 3 cm.)
    out.push_back(scene("lure, twitched", "lure", 4, 160));
    out.back().haptic.path = [](double t) { return Vec3d(0, -1 + 0.5 * t + 0.08 * std::sin(6 * t), -0.15); };
    // Fig. 1, at its whole torque, for the stick; and with the torque that samples/paddle_in_hand.json scales to.
    const KeyframePath keys(paddle_scene);
    for (const float torque : {1.0f, 0.003f}) {
        out.push_back(scene(torque == 1 ? "paddle, whole torque" : "paddle, torque x 0.003", "paddle", 4.8, 200));
        out.back().haptic.path = [keys](double t) { return keys.place(t); };
        out.back().haptic.turning = [keys](double t) { return keys.turn(t); };
        out.back().haptic.mass = 0.9f;
        out.back().haptic.torque_scale = torque;
    }
    return out;
}

inline HapticCase held_by(HapticCase c, const NamedHand& hand) {
    c.device.hand = hand.hand;
    c.grip_mass = hand.grip_mass, c.grip_inertia = hand.grip_inertia;
    return c;
}

/// What is left of quick motion beyond what the water itself does: a limit cycle, where it is over this.
constexpr double limit_cycle = 2e-4, spin_limit_cycle = 1e-2;  ///< m, rad; over twice the motion in the best loop

}  // namespace frm::test
