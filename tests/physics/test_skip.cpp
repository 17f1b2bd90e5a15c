// What a tick skips: with each rule on or off forces and heights agree within the rule's bound, and a counter says that
// it was applied. (Calm tiles: test_wave_step.cpp. Friction and steady sources: test_eq6.cpp. Bodies that stay:
// test_coupling.cpp.)
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;
using test::body_of;

namespace {

std::shared_ptr<const Map> plate_map() {
    static const auto map = test::map_of(test::fine_box({0.05, 0.3, 0.3}, 0.05), 18, 3, 32);
    return map;
}

WorldDef skipping(std::uint32_t skip) {
    WorldDef def;
    def.skip = skip;
    return def;
}

Vec3d force(const Body& body) { return Vec3d(body.forces.total.force); }

/// Waves of `cells` cells, `amplitude` high, across a basin of `n` by `n`.
std::vector<float> waves(std::int32_t n, float cells, float amplitude) {
    std::vector<float> h(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
    for (std::int32_t j = 0; j < n; ++j)
        for (std::int32_t i = 0; i < n; ++i)
            h[static_cast<std::size_t>(j * n + i)] =
                amplitude * std::cos(6.2831853f * (static_cast<float>(i) + 0.5f) / cells);
    return h;
}

}  // namespace

TEST_CASE("a body that no wave can reach is passed over, and its weight goes on", "[skip]") {
    for (const bool water : {false, true}) {
        World on = test::world_of(skipping(skip_default)), off = test::world_of(skipping(skip_nothing));
        Body* bodies[2];
        for (World* world : {&on, &off}) {
            if (water) world->create_water(test::water_of(64, 0.025f, 0.5f));
            BodyDef def = body_of(plate_map(), {0, 0, 2}, {}, {{1, 0, -1}, {1, 2, 3}});
            def.mass = 2;
            def.centre_of_mass = {0.1f, 0.05f, 0};
            bodies[world == &off] = &world->create_body(def);
        }
        for (int t = 0; t < 20; ++t) {
            const Pose pose{{0.01 * t, 0, 2 - 0.001 * t}, test::turned({1, 1, 0}, 0.1 * t)};
            on.set_motion(*bodies[0], pose, {});
            off.set_motion(*bodies[1], pose, {});
            on.tick(0.002f);
            off.tick(0.002f);
            CHECK(bodies[0]->forces.total.force == bodies[1]->forces.total.force);
            CHECK(bodies[0]->forces.total.torque == bodies[1]->forces.total.torque);
        }
        CHECK(on.skipped().dry_bodies == 1);
        CHECK(off.skipped().dry_bodies == 0);
    }
}

TEST_CASE("a body comes out of the water, is passed over, and goes in again as if it had not been", "[skip]") {
    World on = test::world_of(skipping(skip_default)), off = test::world_of(skipping(skip_default & ~skip_dry_bodies));
    Body* bodies[2];
    for (World* world : {&on, &off}) {
        world->create_water(test::water_of(96, 0.025f, 0.5f));
        bodies[world == &off] = &world->create_body(body_of(plate_map(), {0, 0, 0}));
    }
    std::uint32_t passed_over = 0;
    for (int t = 0; t < 5000; ++t) {
        const double z = t < 4000 ? std::min(1.5, 0.001 * t) : 1.5 - 0.002 * (t - 4000);
        for (int k = 0; k < 2; ++k) (k ? off : on).set_motion(*bodies[k], {{0, 0, z}, {}}, {});
        on.tick(0.002f);
        off.tick(0.002f);
        passed_over += on.skipped().dry_bodies;
        REQUIRE(force(*bodies[0]) == force(*bodies[1]));
    }
    INFO("own waves " << bodies[0]->footprint->own.active_cells() << " " << bodies[0]->footprint->own.height_row(20)[20]);
    CHECK(passed_over > 1000);
    CHECK(bodies[0]->wet_sources > 0);
}

TEST_CASE("a wholly wet body takes one evaluation", "[skip]") {
    World on = test::world_of(skipping(skip_default)), off = test::world_of(skipping(skip_nothing));
    Body& a = on.create_body(body_of(plate_map(), {0, 0, -1}));
    Body& b = off.create_body(body_of(plate_map(), {0, 0, -1}));
    for (int t = 0; t < 50; ++t) {
        const Pose pose{{0, 0, -1 - 0.1 * t}, test::turned({1, 2, 3}, 0.2 * t)};
        on.set_motion(a, pose, {});
        off.set_motion(b, pose, {});
        on.tick(0.002f);
        off.tick(0.002f);
        const double weight = 1000 * 9.80665 * 0.05 * 0.3 * 0.3;
        CHECK(length(force(a) - force(b)) < 1e-5 * weight);
        CHECK(length(Vec3d(a.forces.total.torque) - Vec3d(b.forces.total.torque)) < 1e-5 * weight * 0.3);
    }
    CHECK(on.skipped().whole_bodies == 1);
    CHECK(off.skipped().whole_bodies == 0);
}

// Between its steps the water goes on by Eqs. 7 and 8: off by (omega tau)^2 / 2 of a wave at most, tau being how long it
// waits. Waves of 32 cells, tau up to 6 ms: 0.5 %, and as much again because steps of 7 ms are other steps than of 1 ms.
TEST_CASE("water that waits for a longer step moves bodies as if it did not", "[skip]") {
    for (const float dt : {0.001f, 0.002f}) {
        World on = test::world_of(skipping(skip_default)),
              off = test::world_of(skipping(skip_default & ~skip_wave_steps));
        Body* bodies[2];
        for (World* world : {&on, &off}) {
            world->create_water(test::water_of(128, 0.025f, 0.5f, Border::reflecting));
            world->set_height(waves(128, 32, 0.03f).data());
            bodies[world == &off] = &world->create_body(body_of(plate_map(), {0.1, 0, 0}));
        }
        double buoyancy = 0, resistance = 0, largest = 0, strongest = 0;
        float last = 0, rough = 0;
        for (int t = 0; t < 1000; ++t) {
            on.tick(dt);
            off.tick(dt);
            const Forces &a = bodies[0]->forces, &b = bodies[1]->forces;
            buoyancy = std::max(buoyancy, static_cast<double>(std::fabs(a.buoyancy.force.z - b.buoyancy.force.z)));
            largest = std::max(largest, static_cast<double>(std::fabs(b.buoyancy.force.z - 22.06f)));
            resistance = std::max(resistance, static_cast<double>(std::fabs(a.pressure.force.x - b.pressure.force.x)));
            strongest = std::max(strongest, static_cast<double>(std::fabs(b.pressure.force.x)));
            if (t > 0) rough = std::max(rough, std::fabs(a.buoyancy.force.z - last));
            last = a.buoyancy.force.z;
        }
        INFO("largest " << largest << " " << strongest);
        INFO("dt " << dt << ": buoyancy off by " << buoyancy / largest << ", resistance by " << resistance / strongest);
        CHECK(on.skipped().water_waits > 600);
        CHECK(off.skipped().water_waits == 0);
        CHECK(buoyancy < 0.02 * largest);
        CHECK(resistance < 0.03 * strongest);
        CHECK(rough < 3 * largest * 34.8 / 2 * static_cast<double>(dt));  // no stairs: as fast as the waves themselves
    }
}

TEST_CASE("a body too deep to be seen at the surface does not push it", "[skip]") {
    double risen[2] = {}, drag[2] = {};
    for (const bool skips : {false, true}) {
        World world = test::world_of(skipping(skips ? skip_default : skip_default & ~skip_deep_bodies));
        Water& water = world.create_water(test::water_of(128, 0.025f, 3));
        Body& body = world.create_body(body_of(plate_map(), {-0.4, 0, -1.4}));
        std::uint32_t deep = 0;
        for (int t = 0; t < 400; ++t) {
            world.set_motion(body, {{-0.4 + 0.002 * t, 0, -1.4}, {}}, {{1, 0, 0}, {}});
            world.tick(0.002f);
            deep += world.skipped().deep_bodies;
            for (std::int32_t i = 0; i < 128; ++i)
                risen[skips] = std::max(risen[skips], static_cast<double>(std::fabs(water.field.height_row(64)[i])));
        }
        drag[skips] = static_cast<double>(body.forces.pressure.force.x);
        CHECK((deep > 0) == skips);
    }
    INFO("surface " << risen[0] << " and " << risen[1] << " m");
    CHECK(risen[1] == 0);
    CHECK(risen[0] < 0.01 * 1.0 / (2 * 9.81));  // a hundredth of its dynamic head
    CHECK(drag[1] == Approx(drag[0]).epsilon(0.01));
}
