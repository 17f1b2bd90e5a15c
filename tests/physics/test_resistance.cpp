// Eq. 6: its three scalings, torque, and the similarity laws.
#include <algorithm>
#include <cmath>

#include "core/map/lookup.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;
using test::body_of;

namespace {

const std::shared_ptr<const Map>& box_map() {
    static const auto map = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.08), 12, 3, 64);
    return map;
}

struct Steady {
    Vec3d pressure, friction;
    float map_time;
};

/// Mean forces over whole periods of the map, deep in a fluid without a surface.
Steady steady(const Vec3f& velocity, float dt, int ticks, float scale = 1,
              const Fluid& fluid = {9.80665f, 1000, 1e-6f}) {
    WorldDef def;
    def.everywhere = true;
    def.fluid = fluid;
    World world = test::world_of(def);
    BodyDef body_def = body_of(box_map(), {}, {}, {velocity, {}});
    body_def.scale = scale;
    Body& body = world.create_body(body_def);
    Steady out{};
    for (int i = 0; i < ticks; ++i) {
        world.tick(dt);
        out.pressure += Vec3d(body.forces.pressure.force) / static_cast<double>(ticks);
        out.friction += Vec3d(body.forces.friction.force) / static_cast<double>(ticks);
    }
    out.map_time = body.sources[0].map_time;
    return out;
}

}  // namespace

TEST_CASE("pressure goes with the square of the speed, friction with the speed, map time with the speed",
          "[resistance]") {
    const float u0 = box_map()->facts.base_speed, period = box_map()->facts.period;
    const int ticks = 256;
    const Vec3f e(0.6f, -0.64f, 0.48f);
    const Steady base = steady(e * u0, period / ticks, ticks);
    for (const float ratio : {0.1f, 0.5f, 2.0f, 7.0f}) {
        // One period of the map at the other speed takes 1 / ratio of the time.
        const Steady other = steady(e * (u0 * ratio), period / ticks / ratio, ticks);
        const double r = static_cast<double>(ratio);
        CHECK(length(other.pressure - base.pressure * (r * r)) < 1e-5 * r * r * length(base.pressure));
        CHECK(length(other.friction - base.friction * r) < 1e-5 * r * length(base.friction));
        const float apart = std::fabs(other.map_time - base.map_time);
        CHECK(std::fmin(apart, period - apart) < 1e-3f * period);
    }
    const Steady half = steady(e * u0, period / ticks, ticks / 2);
    CHECK(half.map_time == Approx(period / 2).epsilon(1e-4));
}

TEST_CASE("the force is the map's own along a baked direction", "[resistance]") {
    const Map& map = *box_map();
    const std::uint32_t d = 17;
    const Vec3d e = map.directions.direction(d);
    // The water goes along e past a body that moves along -e.
    const Steady s = steady(Vec3f(e) * -map.facts.base_speed, map.facts.period / 256, 256);
    Vec3d expected;
    for (std::uint32_t l = 0; l < map.source_count(); ++l)
        expected += Vec3d(map.mean[d * map.source_count() + l].pressure);
    CHECK(length(s.pressure - expected) < 1e-4 * length(expected));
    CHECK(dot(s.pressure, e) > 0);
}

TEST_CASE("another size, density and viscosity follow the similarity laws", "[resistance]") {
    const float u0 = box_map()->facts.base_speed, period = box_map()->facts.period;
    const Vec3f v = Vec3f(0.2f, 0.9f, 0.1f) * u0;
    const Steady base = steady(v, period / 256, 256);
    const Steady large = steady(v, period / 256 * 3, 256, 3);  // the same part of the map takes three times as long
    CHECK(length(large.pressure - base.pressure * 9.0) < 1e-5 * 9 * length(base.pressure));
    CHECK(length(large.friction - base.friction * 3.0) < 1e-5 * 3 * length(base.friction));
    const Steady heavy = steady(v, period / 256, 256, 1, {9.80665f, 1250, 4e-6f});
    CHECK(length(heavy.pressure - base.pressure * 1.25) < 1e-5 * length(base.pressure));
    CHECK(length(heavy.friction - base.friction * 5.0) < 1e-5 * 5 * length(base.friction));
}

TEST_CASE("torque is about the body's origin", "[resistance]") {
    WorldDef def;
    def.everywhere = true;
    World world = test::world_of(def);
    const Quat<float> q = test::turned({1, 2, -1}, 1.1);
    Body& body = world.create_body(body_of(box_map(), {3, 4, 5}, q, {{0.4f, 0.1f, -0.3f}, {0.5f, -0.2f, 0.9f}}));
    world.tick(0.002f);
    const Rotation<double> r(Quat<double>{static_cast<double>(q.x), static_cast<double>(q.y), static_cast<double>(q.z),
                                          static_cast<double>(q.w)});
    Vec3d torque, force;
    for (std::size_t l = 0; l < body.sources.size(); ++l) {
        const Vec3d f = Vec3d(read_source(body, static_cast<std::uint32_t>(l)).pressure);
        force += f;
        torque += cross(r.to_world(Vec3d(box_map()->sources[l].position)), f);
    }
    CHECK(length(Vec3d(body.forces.pressure.force) - force) < 1e-5 * length(force));
    CHECK(length(Vec3d(body.forces.pressure.torque) - torque) < 1e-5 * length(torque));
    CHECK(length(torque) > 0);
}

TEST_CASE("a source's velocity is the body's motion at the source", "[resistance]") {
    WorldDef def;
    def.everywhere = true;
    World world = test::world_of(def);
    const Vec3f omega(0.3f, -1.2f, 0.8f);
    Body& body = world.create_body(body_of(box_map(), {}, {}, {{}, omega}));
    world.tick(0.002f);
    for (std::size_t l = 0; l < body.sources.size(); ++l) {
        const Vec3f expected = -cross(omega, box_map()->sources[l].position);
        CHECK(length(read_source(body, static_cast<std::uint32_t>(l)).relative_velocity - expected) < 1e-6f);
    }
}

TEST_CASE("a body turned and moved feels the turned force", "[resistance]") {
    WorldDef def;
    def.everywhere = true;
    const auto force = [&](const Quat<float>& q) {
        World world = test::world_of(def);
        const Rotation<float> r(q);
        Body& body = world.create_body(body_of(box_map(), {}, q, {r.to_world({0.3f, 0.2f, -0.1f}), {}}));
        world.tick(0.01f);
        return r.to_body(body.forces.total.force);
    };
    const Vec3f upright = force({});
    const Vec3f turned = force(test::turned({3, -1, 2}, 2.2));
    CHECK(length(upright - turned) < 1e-5f * length(upright));
}

TEST_CASE("a dry source's map time stands still", "[resistance]") {
    World world = test::world_of();
    Body& body = world.create_body(body_of(box_map(), {0, 0, 0}, {}, {{0.5f, 0, 0}, {}}));
    for (int i = 0; i < 10; ++i) world.tick(0.01f);
    int dry = 0, wet = 0;
    for (const SourceState& s : body.sources) {
        CHECK((s.map_time > 0) == (s.wet_ratio > 0));
        ++(s.wet_ratio > 0 ? wet : dry);
    }
    CHECK(dry > 0);
    CHECK(wet > 0);
}

namespace {

/// The drag of the whole body after one tick deep in a fluid, pressure part and friction part, in the body's frame.
struct Drag {
    Vec3d pressure, friction;
};

Drag drag_of(const std::shared_ptr<const Map>& map, const Twist& twist, std::uint32_t model, float scale = 1,
             const Fluid& fluid = {9.80665f, 1000, 1e-6f}, const Quat<float>& turned = {}) {
    WorldDef def;
    def.everywhere = true;
    def.fluid = fluid;
    def.model = model;
    World world = test::world_of(def);
    BodyDef body_def = body_of(map, {1, 2, 3}, turned, twist);
    body_def.scale = scale;
    Body& body = world.create_body(body_def);
    world.tick(1e-6f);
    const Rotation<float> r(turned);
    return {Vec3d(r.to_body(body.forces.pressure.force)), Vec3d(r.to_body(body.forces.friction.force))};
}

std::shared_ptr<const Map> still_map() {
    Map map = test::full_map(test::fine_box({0.2, 0.1, 0.3}, 0.08), 12, 16, 1e-5);
    std::fill(map.step.begin(), map.step.end(), 0.0f);
    map.spin.rate = 0;
    map.spin.force.clear();
    map.complete();
    return std::make_shared<Map>(std::move(map));
}

}  // namespace

TEST_CASE("at each baked speed the force is that speed's own, between them it follows the Reynolds number",
          "[resistance]") {
    const auto map = still_map();
    const float u0 = map->facts.base_speed;
    const Vec3f e(0, -1, 0);
    // full_map: the pressure coefficient is 2, 1 and 4 times the formula's at 0.1, 1 and 3 times the base speed.
    const Drag base = drag_of(map, {e * u0, {}}, model_default);
    const auto coefficient = [&](float speed, std::uint32_t model = model_default, float scale = 1,
                                 const Fluid& fluid = {9.80665f, 1000, 1e-6f}) {
        const double ratio = static_cast<double>(speed) / static_cast<double>(u0), s = static_cast<double>(scale);
        const double density = static_cast<double>(fluid.density) / 1000;
        return drag_of(map, {e * speed, {}}, model, scale, fluid).pressure.y /
               (ratio * ratio * s * s * density * base.pressure.y);
    };
    CHECK(coefficient(u0) == Approx(1));
    CHECK(coefficient(0.1f * u0) == Approx(2).epsilon(1e-4));
    CHECK(coefficient(3 * u0) == Approx(4).epsilon(1e-4));
    CHECK(coefficient(0.001f * u0) == Approx(2).epsilon(1e-4));
    CHECK(coefficient(50 * u0) == Approx(4).epsilon(1e-4));
    CHECK(coefficient(std::sqrt(0.1f) * u0) == Approx(1.5).epsilon(1e-4));
    CHECK(coefficient(std::sqrt(3.0f) * u0) == Approx(2.5).epsilon(1e-4));
    // The same Reynolds number in another size and fluid: a tenth of the speed, ten times as large; as thick as speed.
    CHECK(coefficient(0.1f * u0, model_default, 10) == Approx(1).epsilon(1e-4));
    CHECK(coefficient(3 * u0, model_default, 1, {9.80665f, 800, 3e-6f}) == Approx(1).epsilon(1e-4));
    // Switched off, the base speed's coefficient at all speeds.
    CHECK(coefficient(3 * u0, model_default & ~std::uint32_t{model_speeds}) == Approx(1).epsilon(1e-4));
    CHECK(coefficient(0.1f * u0, model_paper) == Approx(1).epsilon(1e-4));
}

TEST_CASE("pure rotation about a baked axis gives the force that was baked", "[resistance]") {
    const float w0 = 2;
    const DirectionSet axes(1);
    Map map = *still_map();
    // What a flow might have given for each axis: any force on each source.
    const auto truth = [](std::uint32_t axis, std::uint32_t l) {
        const auto a = static_cast<float>(axis + 1), b = static_cast<float>(l + 1);
        return SourceForce{{0.3f * a, -0.2f * b, 0.1f * a * b}, {0.01f * b, 0.02f * a, -0.03f}};
    };
    map.spin.rate = w0;
    map.spin.force.clear();
    for (std::uint32_t axis = 0; axis < 6; ++axis) {
        const Vec3f w = Vec3f(axes.direction(axis)) * w0;
        for (std::uint32_t l = 0; l < map.source_count(); ++l) {
            const SourceForce known = truth(axis, l), rule = mean_force(map, l, -cross(w, map.sources[l].position));
            map.spin.force.push_back({known.pressure - rule.pressure, known.friction - rule.friction});
        }
    }
    map.complete();
    const auto shared = std::make_shared<Map>(map);
    const auto without = still_map();
    const float scale = 1.5f;
    const Fluid fluid{9.80665f, 1200, 2e-6f};
    for (std::uint32_t axis = 0; axis < 6; ++axis) {
        const Vec3f w = Vec3f(axes.direction(axis)) * w0;
        Vec3d pressure, friction;
        for (std::uint32_t l = 0; l < map.source_count(); ++l) {
            pressure += Vec3d(truth(axis, l).pressure);
            friction += Vec3d(truth(axis, l).friction);
        }
        const Drag found = drag_of(shared, {{}, w}, model_default);
        CHECK(length(found.pressure - pressure) < 1e-5 * length(pressure));
        CHECK(length(found.friction - friction) < 1e-5 * length(friction) + 1e-5);
        // However the body lies in the world.
        const Quat<float> q = test::turned({1, -2, 0.5}, 0.9);
        const Drag lying =
            drag_of(shared, {{}, Rotation<float>(q).to_world(w)}, model_default, 1, {9.80665f, 1000, 1e-6f}, q);
        CHECK(length(lying.pressure - pressure) < 1e-4 * length(pressure));
        // Similarity: the same flow at twice the rate, 1.5 times as large, in another fluid of the Reynolds number.
        const Drag rule = drag_of(without, {{}, w * 2.0f}, model_paper, scale, fluid);
        const Drag all = drag_of(shared, {{}, w * 2.0f}, model_spin, scale, fluid);
        const Drag table_rule = drag_of(without, {{}, w}, model_paper), table = drag_of(shared, {{}, w}, model_spin);
        const double s = static_cast<double>(scale), rho = 1.2, mu = 1.2 * 2;
        CHECK(length(all.pressure - rule.pressure -
                     (table.pressure - table_rule.pressure) * (rho * 4 * s * s * s * s)) < 1e-4 * length(all.pressure));
        CHECK(length(all.friction - rule.friction - (table.friction - table_rule.friction) * (mu * 2 * s * s)) <
              1e-4 * length(all.friction) + 1e-5);
        // Switched off: the paper's rule.
        const Drag off = drag_of(shared, {{}, w}, model_default & ~std::uint32_t{model_spin});
        CHECK(off.pressure == drag_of(without, {{}, w}, model_default).pressure);
    }
    // No rotation, nothing added.
    CHECK(drag_of(shared, {{0.4f, 0, 0}, {}}, model_default).pressure ==
          drag_of(without, {{0.4f, 0, 0}, {}}, model_default).pressure);
}

TEST_CASE("a dry source feels nothing of the spin", "[resistance]") {
    Map map = *still_map();
    map.spin.rate = 1;
    map.spin.force.assign(6 * map.sources.size(), {{1, 2, 3}, {0, 0, 0}});
    map.complete();
    WorldDef def;
    World world = test::world_of(def);
    Body& body = world.create_body(body_of(std::make_shared<Map>(map), {0, 0, 0}, {}, {{}, {0, 0, 1}}));
    world.tick(0.01f);
    int dry = 0;
    for (std::uint32_t l = 0; l < body.sources.size(); ++l) {
        if (body.sources[l].wet_ratio > 0) continue;
        ++dry;
        CHECK(read_source(body, l).pressure == Vec3f());
    }
    CHECK(dry > 0);
}

TEST_CASE("a source's pressure lies on the water around it, as wide as its depth asks for", "[resistance]") {
    const FieldDef water = test::water_of(200, 0.025f, 1).field;
    Footprint footprint(water, 0.3f, 0.01, test::memory());
    const double cell = static_cast<double>(water.cell),
                 widest = static_cast<double>(Pyramid::width_of[footprint.levels() - 1]);
    for (const float depth : {0.0f, 0.02f, 0.05f, 0.07f, 0.13f}) {
        for (const float shift : {0.1f, 0.45f, 0.95f}) {
            footprint.begin(100, 100, {100, 100, shift, 0.7f}, nullptr);
            const float p = 1234, area = 0.004f;
            footprint.splat_pressure({0.05f, -0.11f, 0}, p, area, depth);
            footprint.gather_pressure();
            const double d = static_cast<double>(depth) * 1.47;
            const double asked = std::sqrt(0.25 * static_cast<double>(area) + d * d) / cell;
            const double width = std::min(asked, widest);
            const GridOrigin at = footprint.body_in_window();
            const double x = at.i + static_cast<double>(at.x) + 0.05 / cell,
                         y = at.j + static_cast<double>(at.y) - 0.11 / cell;
            double sum = 0, mean_x = 0, mean_y = 0, square = 0;
            for (std::int32_t j = 0; j < footprint.size(); ++j) {
                for (std::int32_t i = 0; i < footprint.size(); ++i) {
                    const double found = static_cast<double>(footprint.pressure()[j * footprint.size() + i]);
                    sum += found, mean_x += found * (i + 0.5 - x), mean_y += found * (j + 0.5 - y);
                    square += found * ((i + 0.5 - x) * (i + 0.5 - x) + (j + 0.5 - y) * (j + 0.5 - y));
                }
            }
            INFO("depth " << depth << " shift " << shift);
            // Deeper than the widest, the middle goes down with the square of the width.
            CHECK(sum * cell * cell ==
                  Approx(static_cast<double>(p * area) * (width / asked) * (width / asked)).epsilon(1e-4));
            CHECK(std::fabs(mean_x / sum) < 1e-3);
            CHECK(std::fabs(mean_y / sum) < 1e-3);
            CHECK(std::sqrt(0.5 * square / sum) == Approx(std::max(width, 0.5)).epsilon(1e-3));
            footprint.end();
        }
    }
}
