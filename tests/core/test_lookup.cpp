#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <random>

#include "core/kernels/kernels.h"
#include "tests/support/catch.h"
#include "tests/support/plain_lookup.h"
#include "tests/support/worlds.h"

using namespace frm;
using namespace frm::test;

TEST_CASE("at a baked direction and sample the lookup gives what was stored", "[lookup]") {
    const auto map = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.1), 6, 2, 16);
    for (std::uint32_t d = 0; d < map->directions.count(); ++d) {
        const MapPlace place = place_of(*map, Vec3f(map->directions.direction(d)), {}, true);
        for (std::uint32_t s = 0; s < map->samples; ++s) {
            const SamplePosition at = sample_position(*map, map->facts.period * static_cast<float>(s) / 16);
            const SourceForce force = look_up(*map, 3, place, at);
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
    const MapPlace place = place_of(*map, {0.3f, 0.5f, -0.2f}, {}, true);
    const float period = map->facts.period;
    const auto at = [&](float time) { return look_up(*map, 2, place, sample_position(*map, time)).pressure; };
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
        const MapPlace place = place_of(*map, d, {}, false);
        const DirectionWeights& e = place.mean;
        const SourceForce force = look_up(*map, l, place, sample_position(*map, time));
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

namespace {

/// A map of six directions whose fluctuations are sines of `frequency[direction]` periods, of one strength on all
/// sources, along y and pressure only.
Map sine_map(const std::array<int, 6>& frequency, std::uint32_t mean_frequency = 1) {
    constexpr std::uint32_t samples = 64, sources = 4;
    Map map = bake::formula_map(test::box({0.2, 0.1, 0.3}), sources, mean_frequency, samples);
    map.fluctuation_directions = DirectionSet(1);
    map.step.assign(6, 0.001f);
    map.fluctuation.assign(6 * sources * samples * Map::components, 0);
    for (std::size_t d = 0; d < 6; ++d)
        for (std::size_t l = 0; l < sources; ++l)
            for (std::size_t s = 0; s < samples; ++s)
                map.fluctuation[((d * sources + l) * samples + s) * Map::components + 1] =
                    static_cast<std::int16_t>(std::lround(
                        1000 * std::sin(2 * 3.14159265358979 * frequency[d] * static_cast<double>(s) / samples)));
    map.complete();
    return map;
}

/// Root mean square of the fluctuation of the force on the whole object.
double rms(const Map& map, const Vec3f& direction, bool repair) {
    const MapPlace place = place_of(map, direction, {}, repair);
    double sum = 0, square = 0;
    for (std::uint32_t s = 0; s < map.samples; ++s) {
        double whole = 0;
        for (std::uint32_t l = 0; l < map.source_count(); ++l)
            whole += static_cast<double>(look_up(map, l, place, {s, s, 0}).pressure.y);
        sum += whole, square += whole * whole;
    }
    return std::sqrt(square / map.samples - sum / map.samples * (sum / map.samples));
}

}  // namespace

TEST_CASE("between directions whose fluctuations have nothing in common the strength is kept", "[lookup]") {
    const Map map = sine_map({2, 3, 5, 7, 11, 13});
    const double one = rms(map, {1, 0, 0}, true);
    CHECK(one == Approx(4 * std::sqrt(0.5)).epsilon(1e-3));
    CHECK(rms(map, {1, 0, 0}, false) == Approx(one).epsilon(1e-6));
    for (const Vec3f d : {Vec3f(1, 1, 0), Vec3f(-1, 0, 1), Vec3f(0, 1, -1)}) {
        CHECK(rms(map, d, true) == Approx(one).epsilon(0.01));
        CHECK(rms(map, d, false) == Approx(one * std::sqrt(0.5)).epsilon(0.01));  // 29 % lost
    }
    CHECK(rms(map, {1, 1, 1}, true) == Approx(one).epsilon(0.01));
    CHECK(rms(map, {1, 1, 1}, false) == Approx(one * std::sqrt(1.0 / 3)).epsilon(0.01));  // 42 % lost
    CHECK(rms(map, {1, 2, 3}, true) == Approx(one).epsilon(0.01));
    // Half a step is all that rounding may change: the 1 % is not used up by it.
    CHECK(rms(map, {1, 1, 0}, true) == Approx(one).epsilon(1e-3));
}

TEST_CASE("the level of a fluctuation is 1 where neighbours agree, at most 2, and continuous", "[lookup]") {
    const Map same = sine_map({3, 3, 3, 3, 3, 3});
    std::mt19937 random(12);
    std::normal_distribution<float> normal;
    const auto level = [](const Map& map, const Vec3f& d) { return place_of(map, d, {}, true).level; };
    Map opposite = sine_map({3, 3, 3, 3, 3, 3});
    for (std::size_t i = 0; i < opposite.fluctuation.size() / 2; ++i)
        opposite.fluctuation[i] = static_cast<std::int16_t>(-opposite.fluctuation[i]);
    opposite.complete();
    const Map apart = sine_map({2, 3, 5, 7, 11, 13});
    float largest = 0;
    for (int i = 0; i < 20000; ++i) {
        const Vec3f d(normal(random), normal(random), normal(random));
        const Vec3f near = d + Vec3f(normal(random), normal(random), normal(random)) * 1e-5f;
        REQUIRE(level(same, d) == Approx(1).epsilon(1e-5));
        largest = std::max(largest, level(opposite, d));
        for (const Map* map : std::array<const Map*, 2>{&opposite, &apart}) {
            REQUIRE(level(*map, d) >= 1);
            REQUIRE(level(*map, d) <= 2);
            REQUIRE(std::fabs(level(*map, d) - level(*map, near)) < 2e-3f);
        }
    }
    CHECK(largest == 2);  // where they cancel
    for (std::uint32_t d = 0; d < 6; ++d) CHECK(level(apart, Vec3f(DirectionSet(1).direction(d))) == 1);
    Map still = sine_map({1, 1, 1, 1, 1, 1});
    std::fill(still.fluctuation.begin(), still.fluctuation.end(), std::int16_t{0});
    still.complete();
    CHECK(level(still, {1, 2, 3}) == 1);
}

TEST_CASE("means and fluctuations are found in their own sets", "[lookup]") {
    const Map fine = sine_map({2, 3, 5, 7, 11, 13}, 3), coarse = sine_map({2, 3, 5, 7, 11, 13}, 1);
    std::mt19937 random(13);
    std::normal_distribution<float> normal;
    for (int i = 0; i < 200; ++i) {
        const Vec3f d(normal(random), normal(random), normal(random));
        for (const bool repair : {false, true}) {
            const MapPlace place = place_of(fine, d, {}, repair);
            const SamplePosition at{static_cast<std::uint32_t>(i) % 63, static_cast<std::uint32_t>(i) % 63 + 1, 0.25f};
            const SourceForce force = look_up(fine, 1, place, at);
            // The fluctuation is that of the coarse map, whose means are others; the mean is the fine map's.
            const MapPlace there = place_of(coarse, d, {}, repair);
            Map no_swing = fine;
            std::fill(no_swing.step.begin(), no_swing.step.end(), 0.0f);
            Map no_coarse_swing = coarse;
            std::fill(no_coarse_swing.step.begin(), no_coarse_swing.step.end(), 0.0f);
            const Vec3f expected = look_up(no_swing, 1, place, at).pressure + look_up(coarse, 1, there, at).pressure -
                                   look_up(no_coarse_swing, 1, there, at).pressure;
            REQUIRE(length(force.pressure - expected) < 1e-4f);
        }
    }
}

TEST_CASE("between speeds the mean is linear in the logarithm, outside the nearest", "[lookup]") {
    const Map map = test::full_map(test::fine_box({0.2, 0.1, 0.3}, 0.1), 6, 8);
    REQUIRE(map.speeds.size() == 3);
    for (std::uint32_t k = 0; k < 3; ++k) {
        const SpeedPosition at = speed_position(map, map.speeds[k]);
        CHECK(at.before == k);
        CHECK(at.share == 0);
    }
    CHECK(speed_position(map, 0.001f).before == 0);
    CHECK(speed_position(map, 0.001f).share == 0);
    CHECK(speed_position(map, 0).before == 0);
    CHECK(speed_position(map, 1e6f).before == 2);
    CHECK(speed_position(map, 1e6f).share == 0);
    const SpeedPosition middle = speed_position(map, std::sqrt(map.speeds[0] * map.speeds[1]));
    CHECK(middle.before == 0);
    CHECK(middle.after == 1);
    CHECK(middle.share == Approx(0.5).epsilon(1e-5));
    const Vec3f d(0.3f, -0.4f, 0.7f);
    const auto mean = [&](const SpeedPosition& speed) {
        Map still = map;
        std::fill(still.step.begin(), still.step.end(), 0.0f);
        return look_up(still, 2, place_of(still, d, speed, true), {}).pressure;
    };
    const Vec3f a = mean({0, 0, 0}), b = mean({1, 1, 0}), between = mean({0, 1, 0.25f});
    CHECK(length(between - (a * 0.75f + b * 0.25f)) < 1e-6f * length(a));
    CHECK(length(a - b * 2.0f) < 0.02f * length(a));  // the formula: twice as much at the lowest speed
}

namespace {

LookupMotion random_motion(const Map& map, std::mt19937& random) {
    std::uniform_real_distribution<float> number(-1, 1);
    LookupMotion m{};
    for (int k = 0; k < 3; ++k) m.velocity[k] = number(random), m.rotation[k] = number(random);
    m.per_base_speed = 1 / map.facts.base_speed;
    m.time = 0.01f;
    m.pressure = 0.9f;
    m.friction = 1.1f;
    m.reynolds_speed = 1.3f;
    m.by_speed = map.speeds.size() > 1 && number(random) > 0;
    m.keep_level = number(random) > 0;
    m.swinging = number(random) > -0.5f;
    m.skip_steady = number(random) > 0;
    m.skip_friction = number(random) > 0.5f;
    m.spinning = map.spin.rate > 0 && number(random) > 0;
    for (std::uint32_t k = 0; k < 3; ++k) m.spin_axis[k] = 2 * k, m.spin_weight[k] = 1.0f / 3;
    m.spin_pressure = m.spin_friction = 0.7f;
    return m;
}

}  // namespace

TEST_CASE("every instruction set looks up the same bits", "[lookup]") {
    const Kernels* sets[max_kernel_sets];
    const std::size_t count = every_kernel_set(sets);
    const bake::Surface box = test::fine_box({0.2, 0.1, 0.3}, 0.08);
    const Map maps[] = {bake::formula_map(box, 23, 4, 20), test::full_map(box, 16, 8)};
    std::mt19937 random(31);
    std::uniform_real_distribution<float> number(-1, 1);
    for (const Map& map : maps) {
        const LookupTable table = lookup_table(map);
        for (int i = 0; i < 3000; ++i) {
            const LookupMotion motion = random_motion(map, random);
            const std::size_t first = map.source_count() > lookup_block && i % 2 ? lookup_block : 0;
            LookupBlock in{};
            in.count = std::min(static_cast<std::uint32_t>(lookup_block), map.source_count() - static_cast<std::uint32_t>(first));
            for (std::size_t s = 0; s < lookup_block && first + s < map.source_count(); ++s) {
                in.wet[s] = number(random);
                in.x[s] = number(random), in.y[s] = number(random);
                in.time[s] = map.facts.period * 0.999f * std::fabs(number(random));
            }
            LookupBlock blocks[max_kernel_sets];
            LookupSum sums[max_kernel_sets] = {};
            for (std::size_t k = 0; k < count; ++k) {
                blocks[k] = in;
                sets[k]->look_up_block(table, motion, blocks[k], first, sums[k]);
                INFO(sets[k]->instructions);
                REQUIRE(std::memcmp(&blocks[k], &blocks[0], offsetof(LookupBlock, count)) == 0);
                REQUIRE(std::memcmp(&sums[k], &sums[0], sizeof sums[0]) == 0);
            }
        }
    }
}

TEST_CASE("numbers that are not finite stay within the tables", "[lookup]") {
    const Map map = test::full_map(test::fine_box({0.2, 0.1, 0.3}, 0.08), 16, 8);
    const LookupTable table = lookup_table(map);
    std::mt19937 random(32);
    const float odd[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f, 1e-45f, -1e-45f, 0, -0.0f, 1e30f};
    std::uniform_int_distribution<int> any(0, 9);
    const Kernels* sets[max_kernel_sets];
    const std::size_t count = every_kernel_set(sets);
    for (int i = 0; i < 3000; ++i) {
        LookupMotion motion = random_motion(map, random);
        motion.by_speed = true;
        for (int k = 0; k < 3; ++k) motion.velocity[k] = odd[any(random)], motion.rotation[k] = odd[any(random)];
        for (std::size_t k = 0; k < count; ++k) {
            LookupBlock block{};
            LookupSum sum{};
            block.count = lookup_block;
            for (std::size_t s = 0; s < lookup_block; ++s) block.wet[s] = 1, block.x[s] = odd[any(random)];
            sets[k]->look_up_block(table, motion, block, 0, sum);  // the sanitizers see what is read
            for (std::size_t s = 0; s < lookup_block; ++s)
                REQUIRE((block.time[s] >= 0 && block.time[s] < map.facts.period));
        }
    }
}

TEST_CASE("a direction's face has the corners and weights that interpolation finds", "[lookup]") {
    std::mt19937 random(33);
    std::normal_distribution<float> normal;
    for (const std::uint32_t n : {1u, 2u, 3u, 5u, 64u}) {
        const DirectionSet set(n);
        for (int i = 0; i < 5000; ++i) {
            Vec3f d(normal(random), normal(random), normal(random));
            if (i % 7 == 0) d[i % 3] = 0;
            if (i < 200) d = Vec3f(set.direction(static_cast<std::uint32_t>(i) % set.count()));
            const FacePlace place = set.locate(d);
            REQUIRE(place.face < set.faces());
            const auto corner = set.corners(place.face);
            const DirectionWeights e = set.interpolate(d);
            // The same point of the octahedron: corners may differ where weights vanish.
            const auto point = [&](std::uint32_t k) {
                const Vec3d v = set.direction(k);
                return v / (std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z));
            };
            Vec3d a, b;
            for (std::size_t k = 0; k < 3; ++k) {
                REQUIRE(place.weight[k] >= 0);
                a += point(corner[k]) * static_cast<double>(place.weight[k]);
                b += point(e.index[k]) * static_cast<double>(e.weight[k]);
            }
            REQUIRE(length(a - b) < 3e-7 + 1e-7 * n);
        }
    }
    for (const float odd : {0.0f, NAN, INFINITY, 1e-45f, 3e38f})
        for (const std::uint32_t n : {1u, 4u, 64u}) CHECK(DirectionSet(n).locate({odd, odd, -odd}).face < 8 * n * n);
}
