#include <cmath>
#include <random>

#include "core/map/lookup.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;

TEST_CASE("at a baked direction and sample the lookup gives what was stored", "[lookup]") {
    const auto map = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.1), 6, 2, 16);
    for (std::uint32_t d = 0; d < map->directions.count(); ++d) {
        const DirectionWeights e = map->directions.interpolate(Vec3f(map->directions.direction(d)));
        for (std::uint32_t s = 0; s < map->samples; ++s) {
            const SamplePosition at = sample_position(*map, map->facts.period * static_cast<float>(s) / 16);
            const SourceForce force = look_up(*map, 3, e, at);
            const SourceForce& mean = map->mean[d * 6 + 3];
            const std::int16_t* stored = &map->fluctuation[((std::size_t{d} * 6 + 3) * 16 + s) * 6];
            for (int c = 0; c < 3; ++c) {
                const float scale = length(mean.pressure) + length(mean.friction);
                REQUIRE(force.pressure[c] ==
                        Approx(mean.pressure[c] + map->step[d] * static_cast<float>(stored[c])).margin(1e-4 * scale));
                REQUIRE(
                    force.friction[c] ==
                    Approx(mean.friction[c] + map->step[d] * static_cast<float>(stored[c + 3])).margin(1e-4 * scale));
            }
        }
    }
}

TEST_CASE("the series is periodic and linear between samples", "[lookup]") {
    const auto map = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.1), 6, 1, 16);
    const DirectionWeights e = map->directions.interpolate({0.3f, 0.5f, -0.2f});
    const float period = map->facts.period;
    const auto at = [&](float time) { return look_up(*map, 2, e, sample_position(*map, time)).pressure; };
    const Vec3f end = at(period * 0.999999f), begin = at(0);
    CHECK(length(end - begin) < 1e-4f * length(begin));
    const Vec3f a = at(0), b = at(period / 16), middle = at(period / 32);
    CHECK(length((a + b) * 0.5f - middle) < 1e-5f * length(a));
    // A time that rounding puts on the period itself must not read past the table.
    const SamplePosition last = sample_position(*map, std::nextafter(period, 0.0f));
    CHECK(last.before == 15);
    CHECK(last.after == 0);
}

TEST_CASE("single precision agrees with a double-precision reading of the map", "[lookup]") {
    const auto map = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.1), 6, 3, 32);
    std::mt19937 random(6);
    std::normal_distribution<float> normal;
    double peak = 0, worst = 0;
    for (const SourceForce& f : map->mean) peak = std::max(peak, length(Vec3d(f.pressure)));
    for (int i = 0; i < 5000; ++i) {
        const Vec3f d(normal(random), normal(random), normal(random));
        const float time = map->facts.period * std::uniform_real_distribution<float>(0, 0.9999f)(random);
        const std::uint32_t l = static_cast<std::uint32_t>(i) % 6;
        const DirectionWeights e = map->directions.interpolate(d);
        const SourceForce force = look_up(*map, l, e, sample_position(*map, time));
        const double position = static_cast<double>(time) / static_cast<double>(map->facts.period) * 32;
        const auto before = static_cast<std::size_t>(position);
        const double share = position - static_cast<double>(before);
        Vec3d expected;
        for (int k = 0; k < 3; ++k) {
            const std::size_t cell = std::size_t{e.index[k]} * 6 + l;
            for (int c = 0; c < 3; ++c) {
                const double a = map->fluctuation[(cell * 32 + before) * 6 + static_cast<std::size_t>(c)];
                const double b = map->fluctuation[(cell * 32 + (before + 1) % 32) * 6 + static_cast<std::size_t>(c)];
                expected[c] += static_cast<double>(e.weight[k]) *
                               (static_cast<double>(map->mean[cell].pressure[c]) +
                                static_cast<double>(map->step[e.index[k]]) * (a + share * (b - a)));
            }
        }
        worst = std::max(worst, length(expected - Vec3d(force.pressure)));
    }
    CHECK(worst < 1e-5 * peak);
}
