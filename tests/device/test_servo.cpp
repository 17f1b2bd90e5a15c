// The servo: its thread, its statistics, its ownership of world and device. Nothing here asserts how long something takes.
#include <atomic>
#include <cmath>
#include <cstring>
#include <thread>

#include "device/servo/latest.h"
#include "device/servo/loop.h"
#include "tests/support/allocations.h"
#include "tests/support/hand_device.h"
#include "tests/support/library.h"
#include "tests/support/locks.h"

using frm::test::Folder;
using frm::test::HandDevice;
using frm::test::HandDeviceDef;
using frm::test::Library;
using namespace frm;

namespace {

struct Scene {
    explicit Scene(const HandDeviceDef& def = {}, std::uint32_t rate = 1000) : hand(def) {
        frm_water water_def_handle = 0;
        REQUIRE(frm_world_create(lib.context, nullptr, &world) == FRM_OK);
        frm_water_def water_def;
        REQUIRE(frm_water_def_init(&water_def, sizeof water_def) == FRM_OK);
        water_def.nx = water_def.ny = 64;
        water_def.snapshot_interval = 0.005f;
        REQUIRE(frm_water_create(world, &water_def, &water_def_handle) == FRM_OK);
        water = water_def_handle;
        frm_body_def body_def;
        REQUIRE(frm_body_def_init(&body_def, sizeof body_def) == FRM_OK);
        body_def.map = lib.map();
        REQUIRE(frm_body_create(world, &body_def, &body) == FRM_OK);
        REQUIRE(frm_device_open(lib.context, &HandDevice::driver(), &hand, 0, &device) == FRM_OK);
        frm_device_safety_def safety;
        REQUIRE(frm_device_safety_def_init(&safety, sizeof safety) == FRM_OK);
        safety.deadline_ns = 10'000'000'000;
        safety.ramp_time = 0.01f;
        REQUIRE(frm_device_set_safety(device, &safety) == FRM_OK);
        REQUIRE(frm_servo_def_init(&servo_def, sizeof servo_def) == FRM_OK);
        servo_def.device = device;
        servo_def.body = body;
        servo_def.rate = rate;
        servo_def.lock_memory = 0;
        hand.target = [](double t) { return Vec3d(0.05 * std::sin(6 * t), 0, -0.05); };
        hand.place({0, 0, -0.05});
    }
    void create() { REQUIRE(frm_servo_create(lib.context, &servo_def, &servo) == FRM_OK); }
    frm_servo_state state() const {
        frm_servo_state s{};
        s.struct_size = sizeof s;
        REQUIRE(frm_servo_get_state(servo, &s) == FRM_OK);
        return s;
    }
    frm_servo_stats stats() const {
        frm_servo_stats s{};
        s.struct_size = sizeof s;
        REQUIRE(frm_servo_get_stats(servo, &s) == FRM_OK);
        return s;
    }
    /// However long that takes; a hung servo meets the test's own limit.
    void wait_for(std::uint64_t ticks) const {
        while (state().running && state().ticks < ticks) std::this_thread::yield();
    }

    Library lib;
    HandDevice hand;
    frm_world world = 0;
    frm_water water = 0;
    frm_body body = 0;
    frm_device device = 0;
    frm_servo_def servo_def{};
    frm_servo servo = 0;
};

frm_status FRM_CALL end_at_100(void*, std::uint64_t tick, float) { return tick < 100 ? FRM_OK : FRM_ERROR_END; }

}  // namespace

TEST_CASE("a servo closes the loop, and others read it meanwhile", "[servo]") {
    Scene scene;
    scene.create();
    REQUIRE(frm_servo_engage(scene.servo) == FRM_OK);
    REQUIRE(frm_servo_start(scene.servo) == FRM_OK);

    std::atomic<bool> done{false};
    std::atomic<int> reads{0}, wrong{0};
    const auto reader = [&] {
        std::uint64_t last = 0;
        std::vector<float> height(64 * 64);
        while (!done) {
            frm_servo_state s{};
            s.struct_size = sizeof s;
            frm_water_state w{};
            w.struct_size = sizeof w;
            w.height = height.data();
            w.capacity = height.size();
            const bool good = frm_servo_get_state(scene.servo, &s) == FRM_OK &&
                              frm_water_read_snapshot(scene.water, &w) == FRM_OK && s.ticks >= last &&
                              std::isfinite(s.wrench.force.x) && std::isfinite(height[100]);
            last = s.ticks;
            wrong += !good;
            ++reads;
            std::this_thread::yield();
        }
    };
    std::thread one(reader), two(reader);
    frm_servo_input input;
    REQUIRE(frm_servo_input_init(&input, sizeof input) == FRM_OK);
    for (int i = 0; i < 200; ++i) {  // the host tells it things all the time
        input.force_scale = 1 + 0.001f * static_cast<float>(i);
        REQUIRE(frm_servo_set_input(scene.servo, &input) == FRM_OK);
        scene.wait_for(static_cast<std::uint64_t>(2 * i));
    }
    scene.wait_for(500);
    // World and device are the servo's.
    frm_forces forces{};
    forces.struct_size = sizeof forces;
    CHECK(frm_body_get_forces(scene.body, &forces) == FRM_ERROR_STATE);
    CHECK(scene.lib.error().find("servo") != std::string::npos);
    frm_coefficients coefficients{};
    coefficients.struct_size = sizeof coefficients;
    CHECK(frm_body_get_coefficients(scene.body, &coefficients) == FRM_ERROR_STATE);
    CHECK(frm_world_tick(scene.world, 0.001f) == FRM_ERROR_STATE);
    CHECK(frm_device_stop(scene.device) == FRM_ERROR_STATE);
    std::uint32_t size = 0;
    CHECK(frm_device_get_raw(scene.device, nullptr, 0, &size) == FRM_ERROR_STATE);
    done = true;
    one.join(), two.join();
    CHECK(wrong == 0);
    CHECK(reads > 0);

    const frm_servo_state running = scene.state();
    CHECK(running.running == 1);
    CHECK(running.engaged == 1);
    CHECK(running.ramp == 1);
    REQUIRE(frm_servo_stop(scene.servo) == FRM_OK);
    const frm_servo_state s = scene.state();
    CHECK(s.running == 0);
    CHECK(s.faults == 0);
    CHECK(s.wrench.force.z > 1);  // a box under water is lifted
    CHECK(std::fabs(s.pose.position.x - s.grip_pose.position.x) < 1e-6);
    CHECK(scene.hand.stops >= 1);

    // Every tick is in both histograms, and in the world's time.
    const frm_servo_stats stats = scene.stats();
    CHECK(stats.ticks == s.ticks);
    for (const std::uint32_t which : {FRM_SERVO_TICK, FRM_SERVO_LATE}) {
        std::uint32_t count = 0;
        REQUIRE(frm_servo_get_histogram(scene.servo, which, nullptr, nullptr, 0, &count) == FRM_OK);
        std::vector<std::uint64_t> edges(count), counts(count);
        REQUIRE(frm_servo_get_histogram(scene.servo, which, edges.data(), counts.data(), count, &count) == FRM_OK);
        std::uint64_t all = 0;
        for (const std::uint64_t n : counts) all += n;
        CHECK(all == stats.ticks);
    }
    CHECK(stats.tick_p50 <= stats.tick_p99);
    CHECK(stats.tick_p99 <= stats.tick_max);
    CHECK(stats.late_p50 <= stats.late_max);
    CHECK(std::fabs(s.time - 0.001 * static_cast<double>(s.ticks)) < 1e-6 * static_cast<double>(s.ticks));

    // From zero again: what was engaged before a stop is not engaged after it.
    REQUIRE(frm_servo_start(scene.servo) == FRM_OK);
    scene.wait_for(20);
    CHECK(scene.state().engaged == 0);
    REQUIRE(frm_servo_destroy(scene.servo) == FRM_OK);
    CHECK(frm_body_get_forces(scene.body, &forces) == FRM_OK);
}

TEST_CASE("a fault ends the force of a running servo, and is cleared from outside", "[servo]") {
    Scene scene;
    scene.hand.leap = {};
    scene.create();
    REQUIRE(frm_servo_engage(scene.servo) == FRM_OK);
    frm_servo_input input;
    REQUIRE(frm_servo_input_init(&input, sizeof input) == FRM_OK);
    scene.hand.faults = FRM_DEVICE_FAULT_SLACK_STRING;
    REQUIRE(frm_servo_start(scene.servo) == FRM_OK);
    scene.wait_for(10);
    const frm_servo_state s = scene.state();
    CHECK((s.faults & FRM_DEVICE_FAULT_SLACK_STRING) != 0);
    CHECK(std::string(s.reason).find("slack") != std::string::npos);
    CHECK(s.device_status == FRM_DEVICE_FAULT);
    CHECK(s.displayed.force.z == 0);
    CHECK(s.running == 1);  // the water goes on
    REQUIRE(frm_servo_engage(scene.servo) == FRM_OK);
    scene.wait_for(scene.state().ticks + 5);
    CHECK(scene.state().engaged == 0);
    REQUIRE(frm_servo_clear_fault(scene.servo) == FRM_OK);
    scene.wait_for(scene.state().ticks + 5);
    CHECK(scene.state().faults == 0);
}

TEST_CASE("a device that fails, and one that ends", "[servo]") {
    Scene scene;
    scene.hand.answer = FRM_ERROR_DEVICE;
    scene.create();
    REQUIRE(frm_servo_start(scene.servo) == FRM_OK);
    scene.wait_for(30);
    CHECK(scene.state().running == 1);
    CHECK(scene.state().status == FRM_ERROR_DEVICE);
    REQUIRE(frm_servo_stop(scene.servo) == FRM_OK);
    const frm_servo_stats stats = scene.stats();
    CHECK(stats.failed_exchanges >= 1);
    CHECK(stats.failed_exchanges <= stats.ticks / 100 + 1);  // asked ten times a second only

    scene.hand.answer = FRM_ERROR_END;
    REQUIRE(frm_servo_start(scene.servo) == FRM_OK);
    while (scene.state().running) std::this_thread::yield();
    CHECK(scene.state().status == FRM_ERROR_END);
    REQUIRE(frm_servo_stop(scene.servo) == FRM_OK);
    REQUIRE(frm_world_tick(scene.world, 0.001f) == FRM_OK);
}

TEST_CASE("a servo's world replays to the same bits", "[servo]") {
    const Folder folder;
    const std::string path = folder.file("servo.frmrec");
    {
        Scene scene;
        scene.servo_def.on_tick = end_at_100;
        frm_recorder recorder = 0;
        REQUIRE(frm_recorder_create(scene.world, path.c_str(), nullptr, &recorder) == FRM_OK);
        REQUIRE(frm_recorder_add_device(recorder, scene.device) == FRM_OK);
        scene.create();
        REQUIRE(frm_servo_engage(scene.servo) == FRM_OK);
        REQUIRE(frm_servo_start(scene.servo) == FRM_OK);
        CHECK(frm_recorder_close(recorder) != FRM_OK);
        while (scene.state().running) std::this_thread::yield();
        CHECK(scene.state().status == FRM_ERROR_END);
        CHECK(scene.state().ticks == 100);
        REQUIRE(frm_servo_destroy(scene.servo) == FRM_OK);
        REQUIRE(frm_recorder_close(recorder) == FRM_OK);
    }
    const Library lib;
    frm_replay replay = 0;
    REQUIRE(frm_replay_open(lib.context, path.c_str(), &replay) == FRM_OK);
    for (int i = 0; i < 100; ++i) {
        frm_replay_step_result result{};
        result.struct_size = sizeof result;
        REQUIRE(frm_replay_step(replay, &result) == FRM_OK);
        REQUIRE(result.diverged == 0);
    }
}

TEST_CASE("a context that ends takes a running servo with it", "[servo]") {
    Scene scene;
    scene.create();
    REQUIRE(frm_servo_engage(scene.servo) == FRM_OK);
    REQUIRE(frm_servo_start(scene.servo) == FRM_OK);
    scene.wait_for(5);
    REQUIRE(frm_context_destroy(scene.lib.context) == FRM_OK);
    CHECK(scene.hand.stops >= 1);
}

TEST_CASE("where the body is that a grip holds", "[servo]") {
    // The grip is 1 m up in an anchor that is turned by 90 degrees about z; the body hangs 0.5 m below the grip.
    device::Attachment a{};
    const float h = std::sqrt(0.5f);
    a.anchor = {{10, 20, 30}, {0, 0, h, h}};
    a.grip = {{0, 0, -0.5}, {0, 0, 0, 1}};
    a.motion_scale = 2;
    const frm_pose grip{{1, 0, 0.5}, {0, 0, 0, 1}};
    const frm_pose body = device::body_pose(a, grip);
    CHECK(std::fabs(body.position.x - 10) < 1e-5);
    CHECK(std::fabs(body.position.y - 22) < 1e-5);  // x of the device is y of the world
    CHECK(std::fabs(body.position.z - (30 + 1 - 0.5)) < 1e-5);
    CHECK(std::fabs(body.rotation.z - h) < 1e-6f);
    // Turning about the device's x is turning about the world's y: the body below swings along -x.
    const frm_twist twist = device::body_twist(a, grip, {{1, 0, 0}, {3, 0, 0}});
    CHECK(std::fabs(twist.linear.y - 2) < 1e-5f);
    CHECK(std::fabs(twist.angular.y - 3) < 1e-5f);
    CHECK(std::fabs(twist.linear.x + 1.5f) < 1e-5f);
    // Power is kept but for the scale of the motion, which is the host's wish.
    a.motion_scale = 1;
    const frm_wrench on_body{{3, -2, 5}, {0.3f, 0.7f, -0.2f}};
    const frm_twist at_grip{{0.3f, -0.4f, 0.9f}, {2, 1, -1}};
    const frm_twist at_body = device::body_twist(a, grip, at_grip);
    const Wrench there = device::about_grip(
        device::lever(a, grip),
        {{on_body.force.x, on_body.force.y, on_body.force.z}, {on_body.torque.x, on_body.torque.y, on_body.torque.z}});
    const frm_wrench felt = device::in_device(
        a, {{there.force.x, there.force.y, there.force.z}, {there.torque.x, there.torque.y, there.torque.z}});
    const auto power = [](const frm_wrench& w, const frm_twist& t) {
        return w.force.x * t.linear.x + w.force.y * t.linear.y + w.force.z * t.linear.z + w.torque.x * t.angular.x +
               w.torque.y * t.angular.y + w.torque.z * t.angular.z;
    };
    CHECK(std::fabs(power(on_body, at_body) - power(felt, at_grip)) < 1e-4f);
}

TEST_CASE("a servo's tick takes no lock and no memory", "[servo]") {
    HandDevice hand((HandDeviceDef()));
    World world = test::world_of(WorldDef());
    world.create_water(test::water_of(64, 0.025f, 0.5f));
    Body& body = world.create_body(test::body_of(test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.1))));
    device::Device device(HandDevice::driver(), &hand, 0);
    frm_device_safety_def safety = device::default_safety();
    safety.deadline_ns = 10'000'000'000;  // a busy machine is no stalled host
    device.set_safety(safety);
    device.prepare();
    hand.target = [](double t) { return Vec3d(0.05 * std::sin(6 * t), 0, -0.05); };
    const api::Axes axes(FRM_AXES_Z_UP_RIGHT);
    device::ServoLoop loop({axes, world, body, device, {{0, 0, 0}, {0, 0, 0, 1}}, 1000, nullptr, nullptr});
    device::Latest<device::ServoRequests> asked;
    device::Latest<frm_servo_state> newest;
    device::Histogram times;
    device::ServoRequests requests;
    requests.engage = true;
    requests.engaging = 1;
    asked.write(requests);
    REQUIRE(loop.tick(asked.read()));
    const std::size_t memory = test::allocations.load(), locks = test::locks.load();
    for (int i = 0; i < 2000; ++i) {
        const bool good = loop.tick(asked.read());
        newest.write(loop.state());
        times.add(static_cast<std::uint64_t>(i));
        if (!good) REQUIRE(good);
    }
    CHECK(test::allocations.load() == memory);
    CHECK(test::locks.load() == locks);
    CHECK(newest.read().ticks == 2001);
    CHECK(newest.read().engaged == 1);
}

TEST_CASE("the newest value is never half of one and half of another", "[servo]") {
    struct Value {
        std::uint64_t parts[20];
    };
    device::Latest<Value> latest;
    std::atomic<bool> done{false};
    std::atomic<int> torn{0};
    const auto read = [&] {
        std::uint64_t last = 0;
        while (!done) {
            const Value v = latest.read();
            for (const std::uint64_t part : v.parts) torn += part != v.parts[0];
            torn += v.parts[0] < last;
            last = v.parts[0];
        }
    };
    std::thread one(read), two(read);
    Value v{};
    for (std::uint64_t n = 1; n <= 100'000; ++n) {
        for (std::uint64_t& part : v.parts) part = n;
        latest.write(v);
    }
    done = true;
    one.join(), two.join();
    CHECK(torn == 0);
    CHECK(latest.read().parts[7] == 100'000);
}

TEST_CASE("histograms know their quantiles to a quarter", "[servo]") {
    device::Histogram h;
    CHECK(h.quantile(0.5) == 0);
    for (std::uint64_t ns = 1; ns <= 100'000; ++ns) h.add(ns);
    for (const double share : {0.01, 0.5, 0.99}) {
        const double got = static_cast<double>(h.quantile(share)), right = share * 100'000;
        CHECK(got >= right);
        CHECK(got <= 1.26 * right);
    }
    CHECK(h.quantile(1) == 100'000);
    h.add(std::uint64_t{1} << 60);
    CHECK(h.quantile(1) == std::uint64_t{1} << 60);
    for (std::uint32_t i = 0; i < device::Histogram::bins; ++i)
        CHECK(device::Histogram::bin_of(device::Histogram::edge(i)) == i);
}
