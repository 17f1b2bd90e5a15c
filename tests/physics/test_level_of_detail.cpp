// Groups of sources in place of sources: the error stays inside the budget, and the budget decides.
#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;
using test::body_of;

namespace {

double num(float v) { return static_cast<double>(v); }

Map still(Map map) {
    std::fill(map.step.begin(), map.step.end(), 0.0f);
    map.complete();
    return map;
}

/// Two bodies that move alike in worlds of their own: one looks up every source, one keeps a budget.
struct Pair {
    static WorldDef within(WorldDef def, float newtons, float us) {
        def.error_budget = newtons;
        def.time_budget = us;
        return def;
    }
    Pair(const std::shared_ptr<const Map>& map, const WorldDef& def, float newtons, float us, float scale = 1)
        : exact_world(test::world_of(def)), world(test::world_of(within(def, newtons, us))) {
        BodyDef body_def = body_of(map);
        body_def.scale = scale;
        exact = &exact_world.create_body(body_def);
        body = &world.create_body(body_def);
    }
    void tick(const Pose& pose, const Twist& twist, float dt = 0.002f) {
        exact_world.set_motion(*exact, pose, twist);
        world.set_motion(*body, pose, twist);
        exact_world.tick(dt);
        world.tick(dt);
    }
    static Vec3d force(const Body& b) { return Vec3d(b.forces.pressure.force) + Vec3d(b.forces.friction.force); }
    static Vec3d torque(const Body& b) { return Vec3d(b.forces.pressure.torque) + Vec3d(b.forces.friction.torque); }
    double error() const { return length(force(*exact) - force(*body)); }
    double torque_error() const { return length(torque(*exact) - torque(*body)); }

    World exact_world, world;
    Body *exact, *body;
};

}  // namespace

TEST_CASE("the error stays inside the budget, whatever the motion", "[detail]") {
    const bake::Surface box = test::fine_box({0.2, 0.1, 0.3}, 0.05);
    std::vector<std::shared_ptr<const Map>> maps;
    maps.push_back(std::make_shared<Map>(bake::formula_map(box, 40, 3, 32)));
    maps.push_back(std::make_shared<Map>(still(bake::formula_map(box, 37, 4, 4))));
    maps.push_back(std::make_shared<Map>(test::full_map(box, 24, 8)));
    Map rough = still(bake::formula_map(box, 33, 2, 4));  // forces that have nothing to do with their neighbours'
    std::mt19937 random(40);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> share(0, 1);
    for (SourceForce& f : rough.mean)
        f = {{normal(random), normal(random), normal(random)}, {0.1f * normal(random), 0.1f * normal(random), 0}};
    rough.complete();
    maps.push_back(std::make_shared<Map>(rough));

    for (std::size_t which = 0; which < maps.size(); ++which) {
        const auto& map = maps[which];
        std::map<std::uint32_t, int> used;
        double closest = 0;
        for (int i = 0; i < 3000; ++i) {
            INFO("map " << which << ", motion " << i);
            WorldDef def;
            def.everywhere = i % 3 != 0;  // else partly wet
            const float scale = 0.5f + 2 * share(random), u0 = map->facts.base_speed;
            const float speed = u0 * std::pow(10.0f, 2 * share(random) - 1);
            const Vec3f v(normal(random), normal(random), normal(random)),
                w(normal(random), normal(random), normal(random));
            Twist twist{v * (speed / length(v)), w * (speed / scale * std::pow(10.0f, 3 * share(random) - 3))};
            if (i % 5 == 0) twist.angular = {};
            const float ratio = (speed + length(twist.angular) * map->tables.reach * scale) / u0;
            const float peak = map->tables.peak_pressure * ratio * ratio * scale * scale + 1e-9f;
            const float budget = peak * std::pow(10.0f, 4 * share(random) - 3);
            Pair pair(map, def, budget, 0, scale);
            pair.tick({{0, 0, 0.1 * num(normal(random))}, test::turned({1, 2, 3}, num(share(random)) * 6)}, twist);
            const double rounding = 3e-6 * num(peak), reach = num(map->tables.reach * scale);
            REQUIRE(pair.error() <= num(pair.body->detail.error) + rounding);
            REQUIRE(pair.torque_error() <= reach * (num(pair.body->detail.error) + rounding));
            REQUIRE(pair.body->detail.error <= budget);
            REQUIRE(!pair.body->detail.over_budget);
            REQUIRE(pair.exact->detail.groups == 0);
            ++used[pair.body->detail.groups];
            if (pair.body->detail.error > 0) closest = std::max(closest, pair.error() / num(pair.body->detail.error));
        }
        INFO("map " << which);
        CHECK(used[0] > 0);       // budgets that only all sources keep
        CHECK(used[1] > 0);       // and that the whole body as one does
        CHECK(used.size() >= 4);  // and some between
        CHECK(closest > 0.02);    // the bound is not so wide that nothing could break it
        CHECK(closest <= 1.001);
    }
}

TEST_CASE("a body that does not turn and does not fluctuate is one group, exactly", "[detail]") {
    const auto map = std::make_shared<Map>(still(bake::formula_map(test::fine_box({0.2, 0.1, 0.3}, 0.05), 40, 3, 4)));
    WorldDef def;
    def.everywhere = true;
    Pair pair(map, def, 1e-9f, 0);
    std::mt19937 random(41);
    std::normal_distribution<float> normal;
    for (int i = 0; i < 500; ++i) {
        pair.tick({}, {{normal(random), normal(random), normal(random)}, {}});
        REQUIRE(pair.body->detail.groups == 1);
        REQUIRE(pair.error() < 1e-5 * length(Pair::force(*pair.exact)));
        REQUIRE(pair.torque_error() < 1e-5 * length(Pair::force(*pair.exact)));
    }
}

TEST_CASE("a spin table is in a group's force", "[detail]") {
    const Map full = still(test::full_map(test::fine_box({0.2, 0.1, 0.3}, 0.05), 24, 8));
    const auto map = std::make_shared<Map>(full);
    WorldDef def;
    def.everywhere = true;
    Pair pair(map, def, 1e30f, 0, 1.5f);
    pair.tick({{}, test::turned({1, 0, 2}, 1)}, {{}, {1, -2, 3}});
    REQUIRE(pair.body->detail.groups == 1);
    const Vec3d with = Pair::force(*pair.body), torque = Pair::torque(*pair.body);
    def.model &= ~std::uint32_t{model_spin};
    Pair without(map, def, 1e30f, 0, 1.5f);
    without.tick({{}, test::turned({1, 0, 2}, 1)}, {{}, {1, -2, 3}});
    const Vec3d of_table = Pair::force(*pair.exact) - Pair::force(*without.exact);
    const Vec3d torque_of_table = Pair::torque(*pair.exact) - Pair::torque(*without.exact);
    CHECK(length(of_table) > 0);
    CHECK(length(with - Pair::force(*without.body) - of_table) < 1e-5 * length(Pair::force(*pair.exact)));
    CHECK(length(torque - Pair::torque(*without.body) - torque_of_table) < 1e-5 * length(Pair::force(*pair.exact)));
}

TEST_CASE("a time budget decides by the number of lookups", "[detail]") {
    const auto map = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.05), 40, 3, 32);
    WorldDef def;
    def.everywhere = true;
    const Twist twist{{0.5f, 0.2f, 0}, {1, 2, 0}};
    std::uint32_t before = 0;
    for (const float us : {0.01f, 0.1f, 0.2f, 0.35f, 0.5f}) {
        Pair pair(map, def, 0, us);
        pair.tick({}, twist);
        INFO(us);
        CHECK(pair.body->detail.groups >= before);
        CHECK(pair.body->detail.groups > 0);
        CHECK(pair.error() <= num(pair.body->detail.error));
        CHECK(pair.body->detail.over_budget == (us < 0.075f));  // what one lookup costs
        before = pair.body->detail.groups;
    }
    CHECK(before == 16);
    Pair enough(map, def, 0, 10);
    enough.tick({}, twist);
    CHECK(enough.body->detail.groups == 0);
    CHECK(Pair::force(*enough.body) == Pair::force(*enough.exact));
    Pair both(map, def, 1e-6f, 0.1f);  // time goes first, and says so
    both.tick({}, twist);
    CHECK(both.body->detail.over_budget);
    CHECK(both.body->detail.groups > 0);
    CHECK(both.body->detail.error > 1e-6f);
}

TEST_CASE("bodies that go under all at once stay within the time budget, and the world tells who does not",
          "[detail]") {
    const auto map = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.05), 40, 3, 32);
    const auto dive = [&](float us, const std::shared_ptr<const Map>& of, double z, bool water) {
        WorldDef def;
        def.time_budget = us;
        World world = test::world_of(def);
        if (water) world.create_water(test::water_of(64, 0.025f, 0.5f));
        std::vector<Body*> bodies;
        for (int i = 0; i < 20; ++i) bodies.push_back(&world.create_body(body_of(of, {3.0 + i, 0, 1})));
        world.tick(0.002f);
        for (Body* body : bodies) world.set_motion(*body, {{3.0 + body->id, 0, z}, {}}, {{0.5f, 0, 0}, {1, 0, 0}});
        world.tick(0.002f);
        return world.skipped();
    };
    auto skipped = dive(2, map, -1, false);  // 0.1 us each
    CHECK(skipped.coarse_bodies == 20);
    CHECK(skipped.over_budget_bodies == 0);
    skipped = dive(1, map, -1, false);
    CHECK(skipped.coarse_bodies == 20);
    CHECK(skipped.over_budget_bodies == 20);
    // Outside the water nothing that they do reaches it.
    skipped = dive(2, map, -1, true);
    CHECK(skipped.coarse_bodies == 20);
    CHECK(skipped.over_budget_bodies == 0);
    // Partly wet, with what spin adds to each source.
    skipped = dive(2, std::make_shared<Map>(test::full_map(test::fine_box({0.2, 0.1, 0.3}, 0.05), 24, 8)), 0, false);
    CHECK(skipped.coarse_bodies == 0);
    CHECK(skipped.over_budget_bodies == 20);
}

TEST_CASE("sources are there to be looked at, and their map time goes on, while groups are looked up", "[detail]") {
    const auto map = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.05), 40, 3, 32);
    WorldDef def;
    def.everywhere = true;
    const Twist twist{{0.5f, 0.2f, 0}, {0, 0, 0}};
    Pair pair(map, def, 1e30f, 0);
    for (int i = 0; i < 100; ++i) pair.tick({}, twist);
    REQUIRE(pair.body->detail.groups == 1);
    for (std::uint32_t l = 0; l < 40; ++l) {
        const SourceReading a = read_source(*pair.exact, l), b = read_source(*pair.body, l);
        CHECK(a.position == b.position);
        CHECK(length(a.relative_velocity - b.relative_velocity) < 1e-6f);
        CHECK(length(a.pressure - b.pressure) <= 0.11f * length(a.pressure) + 1e-5f);  // the formula swings by a tenth
        if (length(a.pressure) > 0.1f) CHECK(length(b.pressure) > 0);
    }
    for (std::size_t l = 0; l < 40; ++l)
        CHECK(pair.body->sources[l].map_time + pair.body->map_time_owed ==
              Approx(pair.exact->sources[l].map_time).epsilon(1e-4));
}

TEST_CASE("in water that moves every source is looked up", "[detail]") {
    const auto map = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.05), 40, 3, 32);
    WorldDef def;
    def.error_budget = 1e30f;
    World world = test::world_of(def);
    world.create_water(test::water_of(64, 0.025f, 0.5f));
    Body& body = world.create_body(body_of(map, {0, 0, -0.3}, {}, {{0.5f, 0, 0}, {}}));
    for (int i = 0; i < 3; ++i) {
        world.tick(0.002f);
        CHECK(body.detail.groups == 0);
    }
}
