#include <algorithm>
#include <atomic>
#include <thread>

#include "core/water/snapshot.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;

TEST_CASE("readers always see one whole snapshot while another thread publishes", "[snapshot]") {
    Field field({32, 32, 0.1f, 1.0f, Border::reflecting, 0}, test::memory());
    SnapshotExchange exchange(field.cells(), test::memory());
    std::atomic<bool> stop{false};
    std::atomic<int> torn{0}, reads{0};
    const auto reader = [&] {
        std::uint64_t last = 0;
        while (!stop.load()) {
            exchange.read([&](const WaterSnapshot& s) {
                for (const float h : s.height)
                    if (h != static_cast<float>(s.tick)) ++torn;
                if (s.tick < last) ++torn;
                last = s.tick;
                ++reads;
            });
        }
    };
    std::thread one(reader), two(reader);
    std::uint64_t published = 0;
    for (std::uint64_t tick = 1; tick <= 20000; ++tick) {
        for (std::int32_t j = 0; j < 32; ++j) std::fill_n(field.height_row(j), 32, static_cast<float>(tick));
        published += exchange.publish(field, tick, 0);
    }
    while (reads.load() < 2) std::this_thread::yield();
    stop = true;
    one.join();
    two.join();
    CHECK(torn.load() == 0);
    // Two readers hold two slots at most, and one is the newest: there is always a fourth.
    CHECK(published == 20000);
}

TEST_CASE("face velocities are averaged to the cells' centres", "[snapshot]") {
    Field field({8, 8, 0.1f, 1.0f, Border::reflecting, 0}, test::memory());
    field.velocity_x_row(2)[3] = 4;
    field.velocity_y_row(3)[5] = 2;
    std::vector<float> u(64), v(64);
    copy_to_centres(field, nullptr, u.data(), v.data());
    CHECK(u[2 * 8 + 2] == 2);
    CHECK(u[2 * 8 + 3] == 2);
    CHECK(u[2 * 8 + 4] == 0);
    CHECK(v[2 * 8 + 5] == 1);
    CHECK(v[3 * 8 + 5] == 1);
}

TEST_CASE("snapshots become rare while nobody reads them, and a read brings the next", "[snapshot]") {
    World world = test::world_of();
    Water& water = world.create_water(test::water_of(32, 0.05f, 0.5f, Border::reflecting, 0));
    const auto newest = [&] {
        std::uint64_t tick = 0;
        water.snapshots.read([&](const WaterSnapshot& snapshot) { tick = snapshot.tick; });
        return tick;
    };
    std::uint64_t ticks = 0;
    const auto run = [&](int count) {
        for (int t = 0; t < count; ++t) world.tick(0.01f);
        ticks += static_cast<std::uint64_t>(count);
    };
    for (int read = 0; read < 10; ++read) {
        run(10);
        CHECK(newest() >= ticks - 2);
    }
    for (const int unread : {500, 5000, 50000}) {  // ticks nobody reads
        CAPTURE(unread);
        run(unread);
        const std::uint64_t last = newest(), oldest = ticks - static_cast<std::uint64_t>(unread) / 8 - 1;
        CHECK(last >= oldest);
        CHECK(last < ticks);
        run(1);
        CHECK(newest() == ticks);
    }
}

TEST_CASE("how many snapshots are made grows with the logarithm of the time nobody reads", "[snapshot]") {
    Water water(test::water_of(32, 0.05f, 0.5f, Border::reflecting, 0), test::memory());
    int made = 0, rounds = 0;
    for (std::uint64_t tick = 0; tick < 1000000; ++tick) {
        const bool is = water.offer_snapshot(tick, static_cast<double>(tick) * 0.002);
        made += is, rounds += is && tick > 100000;
    }
    CHECK(made < 100);
    CHECK(rounds >= 15);  // log(10) / log(8 / 7) = 17
    CHECK(rounds <= 19);
}
