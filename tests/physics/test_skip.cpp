// What a tick skips: with each rule on or off forces and heights agree within the rule's bound, and a counter says that
// it was applied. (Calm tiles: test_wave_step.cpp. Friction and steady sources: test_eq6.cpp. Bodies that stay:
// test_coupling.cpp.)
#include <algorithm>
#include <cmath>
#include <limits>
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
            CHECK(read_source(*bodies[0], 3).position == read_source(*bodies[1], 3).position);
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
    INFO("own waves " << bodies[0]->footprint->own.active_cells() << " "
                      << bodies[0]->footprint->own.height_row(20)[20]);
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

// Between its steps the water goes on by Eqs. 7 and 8; waves run a little farther with longer steps.
TEST_CASE("water that waits for a longer step moves bodies as if it did not", "[skip]") {
    for (const float dt : {0.0001f, 0.0005f}) {
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
        const int ticks = static_cast<int>(std::lround(1 / dt));
        for (int t = 0; t < ticks; ++t) {
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
        CHECK(on.skipped().water_waits > static_cast<std::uint64_t>(ticks) * 6 / 10);
        CHECK(off.skipped().water_waits == 0);
        CHECK(buoyancy < 0.005 * largest);
        CHECK(resistance < 0.005 * strongest);
        CHECK(rough < 3 * largest * 34.8 / 2 * static_cast<double>(dt));  // no stairs: as fast as the waves themselves
    }
}

TEST_CASE("what a moving body displaces while the water waits pushes it as if it did not wait", "[skip]") {
    World on = test::world_of(skipping(skip_default)), off = test::world_of(skipping(skip_default & ~skip_wave_steps));
    Body* bodies[2];
    for (World* world : {&on, &off}) {
        world->create_water(test::water_of(128, 0.025f, 0.5f));
        bodies[world == &off] = &world->create_body(body_of(plate_map(), {0, 0, -0.05}));
    }
    double apart = 0, largest = 0;
    for (int t = 0; t < 2500; ++t) {  // broadside, 5 cm to each side, without its push
        const Pose pose{{0.05 * std::sin(31.4159 * 0.0002 * t), 0, -0.05}, {}};
        for (int k = 0; k < 2; ++k) {
            (k ? off : on).set_motion(*bodies[k], pose, {});
            (k ? off : on).tick(0.0002f);
        }
        if (t < 500) continue;
        const float a = bodies[0]->forces.buoyancy.force.x, b = bodies[1]->forces.buoyancy.force.x;
        apart = std::max(apart, static_cast<double>(std::fabs(a - b)));
        largest = std::max(largest, static_cast<double>(std::fabs(b)));
    }
    INFO("off by " << apart << " of " << largest << " N");
    CHECK(on.skipped().water_waits > 2000);
    CHECK(largest > 1);
    CHECK(apart < 0.02 * largest);  // 0.1 of it while a whole step's time pushed it, not a half
}

TEST_CASE("a pressure that is set again, or while the water waits, counts for its own time", "[skip]") {
    // Ticks of 0.2 ms; in `often` the pressure is set before each, as it was.
    World once = test::world_of(skipping(skip_default)), often = test::world_of(skipping(skip_default));
    std::vector<float> p(64 * 64);
    for (std::int32_t j = 28; j < 36; ++j)
        for (std::int32_t i = 28; i < 36; ++i) p[static_cast<std::size_t>(64 * j + i)] = 20;
    Body* bodies[2];
    for (World* world : {&once, &often}) {
        world->create_water(test::water_of(64, 0.025f, 0.5f));
        bodies[world == &often] = &world->create_body(body_of(plate_map(), {0, 0, -0.05}));
        world->set_pressure(p.data());
    }
    float apart = 0, highest = 0;
    for (int t = 0; t < 2000; ++t) {
        const Pose pose{{0.0001 * t, 0, -0.05}, test::turned({0, 1, 0}, 0.3)};
        for (int k = 0; k < 2; ++k) {
            World& world = k ? often : once;
            world.set_motion(*bodies[k], pose, {{0.5f, 0, 0}, {}});
            if (k) world.set_pressure(p.data());
            world.tick(0.0002f);
        }
    }
    for (std::int32_t j = 0; j < 64; ++j)
        for (std::int32_t i = 0; i < 64; ++i) {
            const float a = once.water()->field.height_row(j)[i], b = often.water()->field.height_row(j)[i];
            apart = std::max(apart, std::fabs(a - b));
            highest = std::max(highest, std::fabs(a));
        }
    INFO("heights apart by " << apart << " of " << highest);
    CHECK(once.skipped().water_waits > 1500);
    CHECK(apart < 1e-4f * highest);
    CHECK(length(force(*bodies[0]) - force(*bodies[1])) < 1e-4 * length(force(*bodies[0])));
}

TEST_CASE("a pressure that is set while the water waits is not felt the wrong way round", "[skip]") {
    // Over a box at rest, set in the middle of a wait: the box felt 3.6 mN less at once, where without the rule it feels the
    // water rise around it, 24 mN more after 20 ticks.
    std::vector<float> p(64 * 64);
    for (std::int32_t j = 0; j < 64; ++j)
        for (std::int32_t i = 0; i < 64; ++i) {
            const float x = (static_cast<float>(i) - 31.5f) / 6, y = (static_cast<float>(j) - 31.5f) / 6;
            p[static_cast<std::size_t>(64 * j + i)] = 490 * std::exp(-x * x - y * y);
        }
    double change[2][20];
    for (const bool waits : {true, false}) {
        World world = test::world_of(skipping(waits ? skip_default : skip_default & ~skip_wave_steps));
        Water& water = world.create_water(test::water_of(64, 0.025f, 0.5f));
        Body& body = world.create_body(body_of(plate_map(), {0, 0, -0.05}));
        for (int t = 0; t < 14; ++t) world.tick(0.0002f);
        const auto before = static_cast<double>(force(body).z);
        const float* const u = water.field.velocity_x_row(31);
        const std::vector<float> still(u, u + 64);
        world.set_pressure(p.data());
        CHECK(std::equal(still.begin(), still.end(), u));
        for (double& c : change[waits]) {
            world.tick(0.0002f);
            c = static_cast<double>(force(body).z) - before;
        }
    }
    const double all = change[0][19];
    CHECK(std::fabs(all) > 1e-3);
    for (int t = 0; t < 20; ++t) {
        INFO("tick " << t << ": " << change[1][t] << " N, " << change[0][t] << " N without waits");
        CHECK(std::fabs(change[1][t] - change[0][t]) < 0.4 * std::fabs(all));  // by the stairs of its steps
        CHECK(change[1][t] * all > -1e-3 * all * all);
    }
}

TEST_CASE("water that is no longer finite is made calm, and the tick says so, without a body too", "[waves]") {
    World world = test::world_of();
    Water& water = world.create_water(test::water_of(32, 0.025f, 0.5f));
    water.field.wake({16, 16, 17, 17});
    water.field.height_row(16)[16] = std::numeric_limits<float>::infinity();
    bool diverged = false;
    for (int t = 0; t < 8 && !diverged; ++t) diverged = !world.tick(0.005f);
    CHECK(diverged);
    CHECK(water.field.height_row(16)[16] == 0);
    CHECK(world.tick(0.005f));
}

TEST_CASE("a body too deep to be seen at the surface does not push it", "[skip]") {
    double risen[2] = {}, drag[2] = {};
    for (const bool skips : {false, true}) {
        World world = test::world_of(skipping(skips ? skip_default : skip_default & ~skip_deep_bodies));
        Water& water = world.create_water(test::water_of(128, 0.025f, 8));
        Body& body = world.create_body(body_of(plate_map(), {-0.4, 0, -3.4}));
        std::uint32_t deep = 0;
        for (int t = 0; t < 400; ++t) {
            world.set_motion(body, {{-0.4 + 0.002 * t, 0, -3.4}, {}}, {{1, 0, 0}, {}});
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
    CHECK(risen[0] < 0.001 * 1.0 / (2 * 9.81));  // a thousandth of its dynamic head
    CHECK(drag[1] == Approx(drag[0]).epsilon(0.01));
}

TEST_CASE("what the host presses is in the water as long as it pressed, whenever the water is stepped", "[skip]") {
    double risen[2] = {};
    for (const bool skips : {false, true}) {
        World world = test::world_of(skipping(skips ? skip_default : skip_nothing));
        Water& water = world.create_water(test::water_of(64, 0.025f, 0.5f, Border::reflecting));
        std::vector<float> pressure(64 * 64);
        for (std::size_t k = 0; k < pressure.size(); ++k)
            pressure[k] = 500 * std::exp(-0.01f * static_cast<float>((k % 64 - 30) * (k % 64 - 30)));
        for (int t = 0; t < 700; ++t) {
            if (t % 7 == 0) world.set_pressure(pressure.data());
            if (t % 7 == 1) world.set_pressure(nullptr);
            world.tick(0.0005f);
        }
        CHECK((world.skipped().water_waits > 0) == skips);
        for (std::int32_t i = 0; i < 64; ++i)
            risen[skips] = std::max(risen[skips], static_cast<double>(std::fabs(water.field.height_row(32)[i])));
    }
    CHECK(risen[0] > 1e-3);
    CHECK(risen[1] == Approx(risen[0]).epsilon(0.02));
}

TEST_CASE("water without gravity goes on, and a body's jump across it harms nothing", "[skip]") {
    WorldDef def;
    def.fluid.gravity = 0;
    World calm = test::world_of(def);
    calm.create_water(test::water_of(64, 0.025f, 0.5f));
    for (int t = 0; t < 20; ++t) calm.tick(0.002f);
    CHECK(calm.skipped().water_waits < 20);
    CHECK(calm.water_behind() < 0.01f);

    for (const std::uint32_t skip : {std::uint32_t{skip_nothing}, std::uint32_t{skip_default}}) {
        World world = test::world_of(skipping(skip));
        world.create_water(test::water_of(200, 0.025f, 0.5f));
        Body& body = world.create_body(body_of(plate_map()));
        for (const double x : {-1.5, -1.5, 1.5, 1.5, -2.4, 2.4, 0.0, 60.0, 0.0}) {
            world.set_motion(body, {{x, 0, 0}, {}}, {});
            CHECK(world.tick(0.02f));
        }
        CHECK(body.wet_sources > 0);
    }
}

TEST_CASE("a body's own waves without displacement are the same where tiles rest", "[skip]") {
    Vec3d drag[2];
    for (const bool skips : {false, true}) {
        WorldDef def = skipping(skips ? skip_default : skip_nothing);
        def.model = model_own_waves;
        World world = test::world_of(def);
        world.create_water(test::water_of(128, 0.025f, 0.5f));
        Body& body = world.create_body(body_of(plate_map(), {-0.5, 0, 0}));
        for (int t = 0; t < 1000; ++t) {
            world.set_motion(body, {{-0.5 + 0.001 * t, 0, 0}, {}}, {{0.5f, 0, 0}, {}});
            world.tick(0.002f);
        }
        drag[skips] = Vec3d(body.forces.pressure.force);
    }
    CHECK(length(drag[1] - drag[0]) < 1e-3 * length(drag[0]));
}

// Translation alone, by semi-implicit Euler, with half the displaced water as added mass.
TEST_CASE("a floating box gains no energy from its own waves, whatever is skipped", "[skip]") {
    float highest[2] = {};
    for (const bool skips : {false, true}) {
        World world = test::world_of(skipping(skips ? skip_default : skip_nothing));
        Water& water = world.create_water(test::water_of(20, 0.1f, 0.5f, Border::reflecting));
        BodyDef def = body_of(test::map_of(test::fine_box({0.2, 0.04, 0.3}, 0.05), 12, 2, 16), {0.1, 0.05, 0.05});
        def.mass = 1.2f;
        Body& body = world.create_body(def);
        Vec3d at(0.1, 0.05, 0.05), velocity;
        const double dt = 0.0005;
        for (int t = 0; t < 40000; ++t) {
            world.set_motion(body, {at, {}}, {Vec3f(velocity), {}});
            world.tick(0.0005f);
            velocity += force(body) * (dt / 1.8);
            at += velocity * dt;
            if (t < 36000) continue;
            for (std::int32_t j = 0; j < 20; ++j)
                for (std::int32_t i = 0; i < 20; ++i)
                    highest[skips] = std::max(highest[skips], std::fabs(water.field.height_row(j)[i]));
        }
    }
    INFO("waves after 20 s: " << highest[0] << " m, with all rules " << highest[1] << " m");
    CHECK(highest[0] > 0);
    CHECK(highest[1] < 1.5f * highest[0] + 1e-4f);
}
