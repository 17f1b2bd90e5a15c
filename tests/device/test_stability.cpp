// Stability in the hand, on maps from a formula. The chart over all rates is docs/haptic-stability.md, of the baked maps.
#include "tests/support/catch.h"
#include "tests/support/haptic_scenes.h"

using namespace frm;
using namespace frm::test;

namespace {

constexpr Hand light{0.1, 1, 50, 2e-4, 2e-3, 0.2}, firm{0.3, 8, 400, 5e-4, 0.02, 2};

std::shared_ptr<const Map> plate() {
    static const auto map = map_of(fine_box({0.2, 0.02, 0.3}, 0.05), 24, 2, 32);
    return map;
}

HapticCase stroke(double rate, const Hand& hand, float scale, bool passivity) {
    HapticCase c;
    c.map = plate();
    c.rate = rate;
    c.device.hand = hand;
    c.device.delay = 1;
    c.device.max_force = 200;
    c.device.max_torque = 20;
    c.force_scale = scale;
    c.passivity = passivity;
    return c;
}

}  // namespace

TEST_CASE("the detector of limit cycles sees them, and nothing else", "[stability]") {
    const auto series = [](auto&& f) {
        std::vector<double> out;
        for (int i = 0; i < 600; ++i) out.push_back(f(i * 0.001));
        return out;
    };
    CHECK(quick_amplitude(series([](double t) { return 0.5 * t; }), 100) < 1e-12);  // a steady stroke
    CHECK(std::fabs(quick_amplitude(
                        series([](double t) { return 0.5 * t + 0.001 * std::sin(2 * 3.14159265 * 40 * t); }), 100) -
                    0.002) < 3e-5);
    CHECK(quick_amplitude(series([](double t) { return 0.01 * std::sin(2 * 3.14159265 * 0.5 * t); }), 100) < 2e-4);
}

// Weak enough it is stable at any rate, and the controller leaves it alone.
TEST_CASE("a stroke that is stable by itself is left as it is", "[stability]") {
    for (const double rate : {100.0, 500.0, 1000.0, 5000.0}) {
        const HapticResult with = run_haptic_case(stroke(rate, firm, 0.1f, true));
        const HapticResult without = run_haptic_case(stroke(rate, firm, 0.1f, false));
        CHECK(with.faults == 0);
        CHECK(with.quick_gain == 1);
        // At 100 Hz a grip of 0.1 kg would not bear all of it, and the servo does not know that this one is heavier.
        if (rate > 100)
            CHECK(with.amplitude == without.amplitude);
        else
            CHECK(std::fabs(with.mean_force - without.mean_force) < 0.01 * without.mean_force);
        CHECK(with.amplitude < 2e-4);
        CHECK(with.mean_force > 0.5);
    }
}

TEST_CASE("at 500 Hz and more, a held stroke has no limit cycle", "[stability]") {
    for (const double rate : {500.0, 1000.0})
        for (const bool passivity : {false, true}) {
            const HapticResult r = run_haptic_case(stroke(rate, firm, 1, passivity));
            const HapticResult best = run_haptic_case(ideal(stroke(rate, firm, 1, false)));
            INFO(rate << " Hz, passivity " << passivity << ": " << r.amplitude << " m, at best " << best.amplitude);
            CHECK(r.amplitude < best.amplitude + 1e-4);
            CHECK(std::fabs(r.mean_force - best.mean_force) < 0.03 * best.mean_force);
        }
}

// Drag that comes too late for a light hand swings up. The same with observer and controller does not.
TEST_CASE("the passivity controller holds what swings up without it", "[stability]") {
    const struct {
        double rate;
        Hand hand;
        float scale;
    } cases[] = {{500, light, 1}, {1000, light, 3}, {250, firm, 1}, {500, firm, 3}};
    for (const auto& c : cases) {
        const HapticResult without = run_haptic_case(stroke(c.rate, c.hand, c.scale, false));
        const HapticResult with = run_haptic_case(stroke(c.rate, c.hand, c.scale, true));
        INFO(c.rate << " Hz, scale " << c.scale << ": " << without.amplitude << " m without, " << with.amplitude
                    << " m with");
        CHECK(without.amplitude > 0.005);
        CHECK(with.amplitude < 0.05 * without.amplitude);
        CHECK(with.damped > 0);
        CHECK(with.faults == 0);
    }
}

// The encoders are coarser for rotation (15 counts are what is left): it helps, but less.
TEST_CASE("the same for torque", "[stability]") {
    const auto turning = [](bool passivity) {
        HapticCase c = stroke(500, light, 0, passivity);
        c.device.max_torque = 0.5f;
        c.torque_scale = 2;
        c.speed = 0;
        c.spin = 6;
        return run_haptic_case(c);
    };
    const HapticResult without = turning(false), with = turning(true);
    INFO(without.amplitude << " rad without, " << with.amplitude << " rad with, faults " << without.faults << " "
                           << with.faults << ", gain " << with.quick_gain << ", damped " << with.damped);
    CHECK(without.amplitude > 0.02);
    CHECK(with.amplitude < 0.6 * without.amplitude);
    CHECK(with.faults == 0);
}

// Weight, a hand that lifts it slowly: all of that is the water's own, not the loop's.
TEST_CASE("the passivity controller keeps its hands off weight and buoyancy", "[stability]") {
    HapticCase c = stroke(1000, firm, 1, true);
    c.speed = 0;
    const HapticResult r = run_haptic_case(c);
    CHECK(r.quick_gain == 1);
    CHECK(r.damped == 0);
}

namespace {

std::vector<PaperScene> scenes_of_formulas() {
    // A paddle's blade, three quarters of a metre below the hand.
    bake::Surface blade = fine_box({0.16, 0.02, 0.45}, 0.06);
    for (Vec3d& v : blade.vertices) v.z -= 0.75;
    return paper_scenes({{"sphere", map_of(icosphere(0.05, 2), 26, 2, 32)},
                         {"plate", map_of(fine_box({0.08, 0.01, 0.3}, 0.04), 20, 2, 32)},
                         {"lure", map_of(fine_box({0.02, 0.08, 0.03}, 0.02), 30, 2, 32)},
                         {"paddle", map_of(blade, 24, 2, 32)}},
                        FRM_TEST_SAMPLES "/paddle_stroke.json");
}

}  // namespace

TEST_CASE("no limit cycle at 500 Hz in the paper's scenes", "[stability]") {
    for (const PaperScene& scene : scenes_of_formulas()) {
        const bool paddle = scene.name.find("paddle") == 0, whole = scene.haptic.torque_scale == 1;
        for (const NamedHand& hand : {light_hand, firm_hand, stick_hand}) {
            // No hand holds 10 N m by a ball of 5 cm: even in the best loop it is thrown about.
            if (paddle && whole && hand.name != std::string("stick")) continue;
            const HapticCase c = held_by(scene.haptic, hand);
            const HapticResult r = run_haptic_case(c), best = run_haptic_case(ideal(c));
            INFO(scene.name << ", " << hand.name << ": " << r.worst << " m, " << r.worst_spin << " rad; at best "
                            << best.worst << " m, " << best.worst_spin << " rad");
            CHECK(r.worst < 2 * best.worst + limit_cycle);
            CHECK(r.worst_spin < 2 * best.worst_spin + spin_limit_cycle);
            CHECK(r.faults == 0);
        }
    }
}

// With the passivity controller alone, as it was, it swung up in translation and rotation.
TEST_CASE("the paddle's stroke swings without what the servo takes off its drag", "[stability]") {
    for (const PaperScene& scene : scenes_of_formulas()) {
        if (scene.name.find("paddle") != 0) continue;
        HapticCase c = held_by(scene.haptic, firm_hand);
        c.passivity = false;
        const HapticResult r = run_haptic_case(c);
        INFO(scene.name << ": " << r.worst << " m, " << r.worst_spin << " rad");
        CHECK(r.worst > 0.05);
        CHECK(r.worst_spin > 1);
    }
}
