// Ticks of changing lengths: games give the time that their last frame took. Steps of the waves that change with them would
// pump the shortest waves (core/world/wave_clock.h): to NaN within seconds, before steps were of one length.
#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/stress/floating.h"
#include "tests/stress/seed.h"
#include "tests/support/catch.h"

using namespace frm;
using namespace frm::test;

namespace {

struct Pattern {
    const char* name;
    std::function<double(Random&, int)> dt;  ///< of tick n, s
};

std::vector<Pattern> patterns() {
    const auto around = [](double rate, double share) {
        return [=](Random& random, int) { return random.uniform(1 - share, 1 + share) / rate; };
    };
    return {
        {"60 and 30 Hz in turn", [](Random&, int n) { return n % 2 ? 1.0 / 30 : 1.0 / 60; }},
        {"60 and 50 Hz in turn", [](Random&, int n) { return n % 2 ? 1.0 / 50 : 1.0 / 60; }},
        {"7.1 and 2 ms in turn", [](Random&, int n) { return n % 2 ? 0.002 : 0.0071; }},
        {"60 Hz, one of ten frames lost", [](Random& random, int) { return (random.once_in(10) ? 2.0 : 1.0) / 60; }},
        {"60 Hz by a fifth", around(60, 0.2)},
        {"144 Hz by a fifth", around(144, 0.2)},
        {"1 kHz by a third", around(1000, 0.33)},
        {"1 to 10 ms", [](Random& random, int) { return random.uniform(0.001, 0.01); }},
        {"60 Hz, a second at 500 Hz, and so on", [](Random&, int n) { return n % 560 < 60 ? 1.0 / 60 : 0.002; }},
        {"10 us to 50 ms", [](Random& random, int) { return random.range(1e-5, 0.05); }}};
}

}  // namespace

TEST_CASE("waves do not grow however long each tick is", "[stress]") {
    Random random(stress_seed());
    const std::int32_t n = 48;
    for (const Pattern& pattern : patterns())
        for (const float depth : {0.2f, 1.0f})
            for (const std::uint32_t skip : {std::uint32_t{skip_nothing}, std::uint32_t{skip_default}}) {
                WorldDef def;
                def.skip = skip;
                World world = world_of(def);
                Water& water = world.create_water(water_of(n, 0.025f, depth, Border::reflecting, 0));
                std::vector<float> heights(static_cast<std::size_t>(n * n));  // waves of all lengths
                for (float& h : heights) h = static_cast<float>(random.uniform(-1e-3, 1e-3));
                world.set_height(heights.data());
                float most = 0;
                double time = 0;
                for (int k = 0; k < 5000 && time < 20; ++k) {
                    const double dt = pattern.dt(random, k);
                    time += dt;
                    REQUIRE(world.tick(static_cast<float>(dt)));
                    if (k % 50 == 0) most = std::max(most, highest(water.field));
                }
                INFO(pattern.name << ", " << depth << " m deep, skip " << skip << ": " << most << " m after " << time
                                  << " s");
                CHECK(most < 8e-3f);
            }
}

TEST_CASE("a stroke feels the same at ticks of changing lengths", "[stress]") {
    // A plate to and fro broadside, three quarters in the water; mean and largest of the force against its motion.
    const auto map = map_of(fine_box({0.05, 0.3, 0.3}, 0.05), 18, 3, 32);
    const auto stroke = [&](const Pattern& pattern, double& largest) {
        Random random(stress_seed());
        World world = world_of(WorldDef{});
        world.create_water(water_of(96, 0.025f, 0.5f, Border::absorbing, 0));
        Body& body = world.create_body(body_of(map, {0, 0, -0.08}));
        double time = 0, sum = 0;
        largest = 0;
        for (int k = 0; time < 12; ++k) {
            const double dt = pattern.dt(random, k);
            time += dt;
            const double speed = 0.6 * std::cos(2 * time);
            world.set_motion(body, {{0.3 * std::sin(2 * time), 0, -0.08}, {}}, {{static_cast<float>(speed), 0, 0}, {}});
            REQUIRE(world.tick(static_cast<float>(dt)));
            if (time < 1) continue;
            const double against = -static_cast<double>(body.forces.total.force.x) * speed;
            sum += against * dt;
            largest = std::max(largest, against);
        }
        return sum / 11;
    };
    double usual_largest = 0;
    const double usual = stroke({"60 Hz", [](Random&, int) { return 1.0 / 60; }}, usual_largest);
    for (const Pattern& pattern : patterns()) {
        double largest = 0;
        const double mean = stroke(pattern, largest);
        INFO(pattern.name << ": " << mean << " W of " << usual << ", at most " << largest << " of " << usual_largest);
        CHECK(std::fabs(mean - usual) < 0.015 * usual);  // at 30 Hz it is off by 4.6 %
        CHECK(largest < 1.3 * usual_largest);            // by single ticks of 50 ms
    }
}

TEST_CASE("a floating box drives no waves at ticks of changing lengths", "[stress]") {
    for (const Pattern& pattern : patterns()) {
        Random random(stress_seed());
        FloatingScene scene;
        scene.with = false, scene.guided = true, scene.tilt = 0, scene.seconds = 40;
        scene.tick = [&](std::size_t n) { return pattern.dt(random, static_cast<int>(n)); };
        const std::vector<double> quarter = let_float(scene).energy;
        INFO(pattern.name << ": " << quarter[0] << " " << quarter[1] << " " << quarter[2] << " " << quarter[3]);
        CHECK(quarter[1] < quarter[0]);
        CHECK(quarter[2] < 1.1 * quarter[1]);
        CHECK(quarter[3] < 1.1 * quarter[2]);
    }
}
