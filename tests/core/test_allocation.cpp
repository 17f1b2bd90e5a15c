// A tick allocates nothing: every operator new of this program is counted.
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/library.h"
#include "tests/support/worlds.h"

using frm::test::allocations_here;

TEST_CASE("a tick and a motion allocate nothing", "[allocation]") {
    using namespace frm;
    World world = test::world_of();
    world.create_water(test::water_of(100, 0.025f, 0.5f));
    Body& body = world.create_body(test::body_of(test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.05))));
    const auto full = std::make_shared<Map>(test::full_map(test::fine_box({0.2, 0.1, 0.3}, 0.05)));
    Body& other = world.create_body(test::body_of(full, {0.5, 0.2, 0}, {}, {{0.1f, 0, 0}, {0, 1, 2}}));
    world.tick(0.002f);
    const std::size_t before = allocations_here();
    for (int t = 0; t < 200; ++t) {
        world.set_motion(body, {{0.004 * t, 0, 0.1 - 0.001 * t}, test::turned({1, 0, 0}, 0.01 * t)},
                         {{2, 0, -0.5f}, {5, 0, 0}});
        world.tick(0.002f);
    }
    CHECK(allocations_here() == before);
    CHECK(body.wet_sources > 0);
    CHECK(other.wet_sources > 0);
    std::vector<int> seen(3);
    CHECK(allocations_here() > before);
}

TEST_CASE("a tick, a motion and an exchange that are recorded allocate nothing", "[allocation]") {
    const frm::test::Folder folder;
    const frm::test::Library lib;
    frm_world world = 0;
    frm_body body = 0;
    frm_device device = 0;
    frm_recorder recorder = 0;
    REQUIRE(frm_world_create(lib.context, nullptr, &world) == FRM_OK);
    frm_body_def def;
    REQUIRE(frm_body_def_init(&def, sizeof def) == FRM_OK);
    def.map = lib.map();
    REQUIRE(frm_body_create(world, &def, &body) == FRM_OK);
    REQUIRE(frm_device_open_null(lib.context, &device) == FRM_OK);
    REQUIRE(frm_recorder_create(world, folder.file("r.frmrec").c_str(), nullptr, &recorder) == FRM_OK);
    REQUIRE(frm_recorder_add_device(recorder, device) == FRM_OK);
    const std::size_t before = allocations_here();
    bool good = true;
    for (int t = 0; t < 500; ++t) {
        frm_device_state state{};
        state.struct_size = sizeof state;
        good &= frm_device_exchange(device, nullptr, &state) == FRM_OK;
        state.pose.position.x = 0.001 * t;
        good &= frm_body_set_motion(body, &state.pose, nullptr) == FRM_OK;
        good &= frm_world_tick(world, 0.002f) == FRM_OK;
    }
    CHECK(allocations_here() == before);
    CHECK(good);
    REQUIRE(frm_recorder_close(recorder) == FRM_OK);
    CHECK(allocations_here() > before);
}
