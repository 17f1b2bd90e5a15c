// A tick allocates nothing: every operator new of this program is counted.
#include "tests/support/allocations.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using frm::test::allocations;

TEST_CASE("a tick and a motion allocate nothing", "[allocation]") {
    using namespace frm;
    World world = test::world_of();
    world.create_water(test::water_of(100, 0.025f, 0.5f));
    Body& body = world.create_body(test::body_of(test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.05))));
    const auto full = std::make_shared<Map>(test::full_map(test::fine_box({0.2, 0.1, 0.3}, 0.05)));
    Body& other = world.create_body(test::body_of(full, {0.5, 0.2, 0}, {}, {{0.1f, 0, 0}, {0, 1, 2}}));
    world.tick(0.002f);
    const std::size_t before = allocations.load();
    for (int t = 0; t < 200; ++t) {
        world.set_motion(body, {{0.004 * t, 0, 0.1 - 0.001 * t}, test::turned({1, 0, 0}, 0.01 * t)},
                         {{2, 0, -0.5f}, {5, 0, 0}});
        world.tick(0.002f);
    }
    CHECK(allocations.load() == before);
    CHECK(body.wet_sources > 0);
    CHECK(other.wet_sources > 0);
    std::vector<int> seen(3);
    CHECK(allocations.load() > before);
}
