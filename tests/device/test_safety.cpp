// Each rule of the safety layer, provoked. Whatever goes wrong: the force is bounded, then none; the fault stays, with its
// reason; and the way back begins at zero. Time is the device's own here, so a slow machine changes nothing.
#include <chrono>
#include <cmath>
#include <thread>

#include "tests/support/hand_device.h"
#include "tests/support/library.h"

using frm::test::HandDevice;
using frm::test::HandDeviceDef;
using frm::test::Library;
using namespace frm;

namespace {

constexpr std::uint64_t never = 10'000'000'000;  ///< ns: longer than any test waits

double size(const frm_vec3& v) {
    return std::sqrt(static_cast<double>(v.x) * static_cast<double>(v.x) +
                     static_cast<double>(v.y) * static_cast<double>(v.y) +
                     static_cast<double>(v.z) * static_cast<double>(v.z));
}

/// A device in a hand behind the safety layer, at 1 kHz of simulated time.
struct Rig {
    explicit Rig(const HandDeviceDef& hand_def = {}, const frm_device_safety_def* own = nullptr) : hand(hand_def) {
        REQUIRE(frm_device_open(lib.context, &HandDevice::driver(), &hand, 0, &device) == FRM_OK);
        REQUIRE(frm_device_safety_def_init(&def, sizeof def) == FRM_OK);
        if (own)
            def = *own;
        else
            def.deadline_ns = never, def.ramp_time = 0.1f;
        def.passivity = own ? own->passivity : 0;  // the other rules by themselves; test_stability.cpp has that one
        REQUIRE(frm_device_set_safety(device, &def) == FRM_OK);
    }

    frm_device_state exchange(const frm_vec3& force = {0, 0, 0}, frm_status expected = FRM_OK) {
        frm_device_command command{};
        command.struct_size = sizeof command;
        command.wrench.force = force;
        frm_device_state state{};
        state.struct_size = sizeof state;
        REQUIRE(frm_device_exchange(device, &command, &state) == expected);
        REQUIRE(size(hand.commanded.force) <= 20.0001);  // the device's own limit, whatever happens
        return state;
    }
    void run(int cycles, const frm_vec3& force) {
        for (int i = 0; i < cycles; ++i) exchange(force);
    }
    /// Engaged, and at the whole force.
    void start(const frm_vec3& force = {0, 5, 0}) {
        REQUIRE(frm_device_engage(device) == FRM_OK);
        run(200, force);
        REQUIRE(safety().engaged == 1);
        REQUIRE(safety().ramp == 1);
        REQUIRE(std::fabs(hand.told.force.y - force.y) < 1e-3f);
    }
    frm_device_safety_state safety() const {
        frm_device_safety_state state{};
        state.struct_size = sizeof state;
        REQUIRE(frm_device_get_safety(device, &state) == FRM_OK);
        return state;
    }
    bool faulty(std::uint32_t fault) const { return (safety().faults & fault) == fault; }

    /// What follows any fault: no force, whatever is commanded, until the host clears it and engages anew, from zero.
    void check_latched_and_restart(std::uint32_t fault, const char* reason) {
        INFO(safety().reason);
        CHECK(faulty(fault));
        CHECK(std::string(safety().reason).find(reason) != std::string::npos);
        CHECK(safety().engaged == 0);
        run(20, {0, 5, 0});
        CHECK(size(hand.told.force) == 0);
        CHECK(faulty(fault));
        CHECK(frm_device_engage(device) == FRM_ERROR_STATE);
        CHECK(lib.error().find(reason) != std::string::npos);
        check_restart();
    }
    void check_restart() {
        CHECK(frm_device_clear_fault(device) == FRM_OK);
        run(5, {0, 5, 0});
        CHECK(size(hand.told.force) == 0);  // cleared is not engaged
        REQUIRE(frm_device_engage(device) == FRM_OK);
        double last = 0;
        for (int i = 0; i < 200; ++i) {
            exchange({0, 5, 0});
            REQUIRE(size(hand.told.force) <= last + 5 * 0.001 / static_cast<double>(def.ramp_time) + 1e-3);
            last = size(hand.told.force);
        }
        CHECK(std::fabs(last - 5) < 1e-3);
        CHECK(safety().faults == 0);
        CHECK(safety().reason[0] == 0);
    }

    Library lib;
    HandDevice hand;
    frm_device device = 0;
    frm_device_safety_def def{};
};

}  // namespace

// A driver need not ramp by itself: SPIDAR-G's does not.
TEST_CASE("safety: calibrating an engaged device begins its force anew, wherever the poses are then", "[safety]") {
    Rig rig;
    rig.start({0, 5, 0});
    REQUIRE(frm_device_calibrate(rig.device) == FRM_OK);
    rig.hand.leap = {0.5, 0, 0};  // what was 0.5 m away is the centre now: no fault
    double last = 0;
    for (int i = 0; i < 200; ++i) {
        rig.exchange({0, 5, 0});
        REQUIRE(size(rig.hand.told.force) <= last + 5 * 0.001 / static_cast<double>(rig.def.ramp_time) + 1e-3);
        last = size(rig.hand.told.force);
    }
    CHECK(std::fabs(last - 5) < 1e-3);
    CHECK(rig.safety().faults == 0);
    CHECK(rig.safety().engaged == 1);
}

TEST_CASE("safety: nothing is felt before a device is engaged", "[safety]") {
    Rig rig;
    rig.run(50, {0, 5, 0});
    CHECK(size(rig.hand.told.force) == 0);
    CHECK(rig.safety().engaged == 0);
    rig.check_restart();
    REQUIRE(frm_device_disengage(rig.device) == FRM_OK);
    rig.run(10, {0, 5, 0});  // twice slew_time
    CHECK(size(rig.hand.told.force) == 0);
    rig.check_restart();
    REQUIRE(frm_device_stop(rig.device) == FRM_OK);
    rig.exchange({0, 5, 0});
    CHECK(size(rig.hand.told.force) == 0);
}

TEST_CASE("safety: magnitude and slew", "[safety]") {
    Rig rig;
    rig.start({0, 0, 0});
    double last = 0;
    for (int i = 0; i < 50; ++i) {
        rig.exchange({1e6f, 0, 0});
        const double now = size(rig.hand.told.force);
        REQUIRE(now <= last + 20.0 / 5 + 1e-3);  // all of it in slew_time, 5 ms
        last = now;
    }
    CHECK(std::fabs(last - 20) < 1e-3);
    CHECK(rig.safety().limited > 0);
    CHECK(rig.safety().faults == 0);

    // A host may ask for less than the device has, not for more.
    for (const float most : {8.0f, 100.0f}) {
        frm_device_safety_def def = rig.def;
        def.max_force = most;
        const Rig less_or_more(HandDeviceDef{}, &def);
        Rig& other = const_cast<Rig&>(less_or_more);
        other.start({0, 0, 0});
        other.run(50, {0, 1e3f, 0});
        CHECK(std::fabs(size(other.hand.told.force) - std::min(20.0f, most)) < 1e-3);
    }
}

TEST_CASE("safety: a command that is not finite", "[safety]") {
    Rig rig;
    rig.start();
    const std::uint32_t exchanges = rig.hand.exchanges, stops = rig.hand.stops;
    rig.exchange({NAN, 0, 0}, FRM_ERROR_ARGUMENT);
    CHECK(rig.hand.exchanges == exchanges);  // it was not told, but stopped
    CHECK(rig.hand.stops == stops + 1);
    CHECK(size(rig.hand.told.force) == 0);
    rig.check_latched_and_restart(FRM_DEVICE_FAULT_COMMAND, "not finite");
}

TEST_CASE("safety: a force step", "[safety]") {
    Rig rig;
    rig.def.max_step = 50;
    REQUIRE(frm_device_set_safety(rig.device, &rig.def) == FRM_OK);
    rig.start();
    rig.run(10, {0, 45, 0});
    CHECK(rig.safety().faults == 0);
    rig.exchange({0, 1000, 0});
    CHECK(size(rig.hand.told.force) == 0);
    CHECK(rig.hand.stops == 1);
    rig.check_latched_and_restart(FRM_DEVICE_FAULT_STEP, "leapt, by 955 N");
}

TEST_CASE("safety: a grip that runs away is braked", "[safety]") {
    HandDeviceDef def;
    def.hand = {0.2, 0.5, 0};  // nobody holds it
    Rig rig(def);
    REQUIRE(frm_device_engage(rig.device) == FRM_OK);
    int cycles = 0;
    while (rig.safety().faults == 0 && ++cycles < 2000) rig.exchange({0, 15, 0});
    REQUIRE(rig.faulty(FRM_DEVICE_FAULT_SPEED));
    const double runaway = length(rig.hand.velocity());
    CHECK(runaway < 3.5);  // max_speed, and what a filtered velocity is late by
    rig.exchange({0, 15, 0});
    CHECK(rig.hand.told.force.y < -1);  // against the motion, not what was commanded
    rig.run(100, {0, 15, 0});
    CHECK(length(rig.hand.velocity()) < 0.8 * runaway);
    rig.run(200, {0, 15, 0});
    CHECK(size(rig.hand.told.force) == 0);  // brake_time is over
    rig.hand.hold({});                      // somebody takes it
    rig.hand.place({0, 0, 0});
    rig.check_latched_and_restart(FRM_DEVICE_FAULT_SPEED, "ran away, at 3");
}

TEST_CASE("safety: a host that stalls", "[safety]") {
    frm_device_safety_def def;
    REQUIRE(frm_device_safety_def_init(&def, sizeof def) == FRM_OK);
    def.deadline_ns = 1'000'000;
    def.ramp_time = 0;
    def.passivity = 0;
    Rig rig(HandDeviceDef{}, &def);
    REQUIRE(frm_device_engage(rig.device) == FRM_OK);
    // However slow this machine is, the watchdog comes, and a host that comes back finds what it did. (It may come between
    // any two of these exchanges.)
    rig.exchange({0, 5, 0});
    for (int i = 0; i < 60'000 && rig.hand.stops == 0; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    REQUIRE(rig.hand.stops >= 1);
    CHECK(size(rig.hand.told.force) == 0);
    rig.exchange({0, 5, 0});
    CHECK(size(rig.hand.told.force) == 0);
    CHECK(rig.faulty(FRM_DEVICE_FAULT_DEADLINE));
    CHECK(std::string(rig.safety().reason).find("deadline") != std::string::npos);
    rig.def.deadline_ns = never;
    rig.def.ramp_time = 0.1f;
    REQUIRE(frm_device_set_safety(rig.device, &rig.def) == FRM_OK);
    rig.check_restart();
}

TEST_CASE("safety: missed deadlines, by the device's clock", "[safety]") {
    Rig rig;
    rig.def.deadline_ns = 50'000'000;
    REQUIRE(frm_device_set_safety(rig.device, &rig.def) == FRM_OK);
    frm_device_command command{};
    command.struct_size = sizeof command;
    command.deadline_ns = never;  // this machine's clock is not what is tested
    const auto exchange = [&](std::uint64_t deadline) {
        command.deadline_ns = deadline;
        command.wrench.force.y = 5;
        frm_device_state state{};
        state.struct_size = sizeof state;
        REQUIRE(frm_device_exchange(rig.device, &command, &state) == FRM_OK);
    };
    REQUIRE(frm_device_engage(rig.device) == FRM_OK);
    for (int i = 0; i < 200; ++i) exchange(never);
    rig.hand.lost_ns = 9'000'000'000;
    exchange(never);
    CHECK(rig.safety().faults == 0);
    rig.hand.lost_ns = 11'000'000'000;
    exchange(never);
    CHECK(rig.faulty(FRM_DEVICE_FAULT_DEADLINE));
    CHECK(size(rig.hand.told.force) == 0);
    rig.def.deadline_ns = never;
    REQUIRE(frm_device_set_safety(rig.device, &rig.def) == FRM_OK);
    rig.check_latched_and_restart(FRM_DEVICE_FAULT_DEADLINE, "deadline");
}

TEST_CASE("safety: unplugged in mid stroke", "[safety]") {
    Rig rig;
    rig.start();
    rig.hand.answer = FRM_ERROR_DEVICE;  // every call fails from now on
    rig.exchange({0, 5, 0}, FRM_ERROR_DEVICE);
    CHECK(rig.hand.stops == 1);
    CHECK(size(rig.hand.told.force) == 0);
    rig.exchange({0, 5, 0}, FRM_ERROR_DEVICE);
    rig.hand.answer = FRM_OK;  // plugged in again
    rig.check_latched_and_restart(FRM_DEVICE_FAULT_DRIVER, "driver failed");
}

TEST_CASE("safety: what the driver reports", "[safety]") {
    const struct {
        std::uint32_t fault;
        const char* reason;
    } cases[] = {{FRM_DEVICE_FAULT_SHORT_PACKET, "too short"}, {FRM_DEVICE_FAULT_TIMEOUT, "in time"},
                 {FRM_DEVICE_FAULT_UNPLUGGED, "unplugged"},    {FRM_DEVICE_FAULT_STUCK_ENCODER, "encoder is stuck"},
                 {FRM_DEVICE_FAULT_SLACK_STRING, "slack"},     {FRM_DEVICE_FAULT_BROKEN_STRING, "broken"},
                 {FRM_DEVICE_FAULT_UNCALIBRATED, "calibrat"}};
    for (const auto& c : cases) {
        Rig rig;
        rig.start();
        rig.hand.faults = c.fault;
        CHECK(rig.exchange({0, 5, 0}).status == FRM_DEVICE_FAULT);
        CHECK(rig.hand.stops == 1);
        CHECK(size(rig.hand.told.force) == 0);
        rig.exchange({0, 5, 0});
        CHECK(size(rig.hand.told.force) == 0);
        // Cleared and engaged while the cause is there, it comes back.
        REQUIRE(frm_device_clear_fault(rig.device) == FRM_OK);
        REQUIRE(frm_device_engage(rig.device) == FRM_OK);
        rig.run(10, {0, 5, 0});
        CHECK(size(rig.hand.told.force) == 0);
        CHECK(rig.faulty(c.fault));
        rig.hand.faults = 0;
        rig.check_latched_and_restart(c.fault, c.reason);
    }
    // By its status alone.
    for (const std::uint32_t status : {1u, 2u, 7u}) {
        Rig rig;
        rig.start();
        rig.hand.status = status;
        rig.exchange({0, 5, 0});
        rig.hand.status = FRM_DEVICE_READY;
        const bool calibration = status == FRM_DEVICE_UNCALIBRATED;
        rig.check_latched_and_restart(calibration ? FRM_DEVICE_FAULT_UNCALIBRATED : FRM_DEVICE_FAULT_DRIVER,
                                      calibration ? "calibrat" : "driver failed");
    }
}

TEST_CASE("safety: states that cannot be", "[safety]") {
    Rig leaping;
    leaping.start();
    leaping.hand.leap = {0.2, 0, 0};
    leaping.exchange({0, 5, 0});
    CHECK(leaping.hand.stops == 1);
    leaping.check_latched_and_restart(FRM_DEVICE_FAULT_JUMP, "pose leapt");

    Rig broken;
    broken.start();
    broken.hand.bad_pose = true;
    broken.exchange({0, 5, 0}, FRM_ERROR_DEVICE);
    CHECK(broken.hand.stops >= 1);
    broken.hand.bad_pose = false;
    broken.check_latched_and_restart(FRM_DEVICE_FAULT_STATE, "cannot be");

    Rig frozen;  // a driver that repeats its last state: an encoder that is stuck, or a loop that hangs below
    frozen.start();
    frozen.hand.frozen = true;
    frozen.run(21, {0, 5, 0});  // the state that is repeated is news once
    CHECK(frozen.safety().faults == 0);
    frozen.exchange({0, 5, 0});
    CHECK(frozen.faulty(FRM_DEVICE_FAULT_STALE));
    frozen.hand.frozen = false;
    frozen.check_latched_and_restart(FRM_DEVICE_FAULT_STALE, "stands still");
}

TEST_CASE("safety: engaged inside a strong current", "[safety]") {
    HandDeviceDef def;
    def.hand = {0.3, 8, 400};
    frm_device_safety_def limits;
    REQUIRE(frm_device_safety_def_init(&limits, sizeof limits) == FRM_OK);
    limits.deadline_ns = never;
    limits.passivity = 0;
    Rig rig(def, &limits);
    rig.run(100, {0, 500, 0});  // it flows while nobody is engaged
    REQUIRE(frm_device_engage(rig.device) == FRM_OK);
    double last = 0;
    for (int i = 0; i < 3000; ++i) {
        rig.exchange({0, 500, 0});
        const double now = size(rig.hand.told.force);
        REQUIRE(now <= last + 0.501);  // 500 N in ramp_time, a second
        last = now;
    }
    CHECK(std::fabs(last - 20) < 1e-3);
    CHECK(rig.safety().faults == 0);
    CHECK(std::fabs(rig.hand.position().y - 20.0 / 400) < 0.005);  // the hand gave way, and holds
    CHECK(length(rig.hand.velocity()) < 0.01);

    // And let go: it runs away, is braked, and is without force.
    rig.hand.faults = FRM_DEVICE_FAULT_UNPLUGGED;
    rig.exchange({0, 500, 0});
    CHECK(size(rig.hand.told.force) == 0);
}

TEST_CASE("safety: engaging what is not ready", "[safety]") {
    Rig rig;
    rig.hand.status = FRM_DEVICE_UNCALIBRATED;
    rig.exchange();
    CHECK(rig.safety().faults == 0);  // nothing is pushed: nothing is wrong
    REQUIRE(frm_device_engage(rig.device) == FRM_OK);
    CHECK(rig.safety().engaged == 2);
    rig.exchange({0, 5, 0});
    CHECK(rig.faulty(FRM_DEVICE_FAULT_UNCALIBRATED));
    rig.hand.status = FRM_DEVICE_READY;
    REQUIRE(frm_device_calibrate(rig.device) == FRM_OK);
    rig.check_latched_and_restart(FRM_DEVICE_FAULT_UNCALIBRATED, "calibrat");
}

TEST_CASE("safety: a deadline that passed before engaging is none", "[safety]") {
    // A driver with a watchdog of its own says with the first exchange after a pause that it rested.
    Rig rig;
    REQUIRE(frm_device_engage(rig.device) == FRM_OK);
    rig.hand.faults = FRM_DEVICE_FAULT_DEADLINE;
    rig.exchange({0, 5, 0});
    CHECK(rig.safety().faults == 0);
    CHECK(rig.safety().engaged == 1);
    rig.run(10, {0, 5, 0});
    CHECK(rig.faulty(FRM_DEVICE_FAULT_DEADLINE));  // but from then on it is
}

TEST_CASE("safety: the dead man's grip and buttons", "[safety]") {
    Rig rig;
    rig.def.dead_man_grip = 0.5f;
    rig.def.dead_man_buttons = 6;
    REQUIRE(frm_device_set_safety(rig.device, &rig.def) == FRM_OK);
    REQUIRE(frm_device_engage(rig.device) == FRM_OK);
    rig.hand.buttons = 1;
    rig.run(200, {0, 5, 0});
    CHECK(size(rig.hand.told.force) == 0);
    rig.hand.buttons = 4;
    rig.exchange({0, 5, 0});
    rig.exchange({0, 5, 0});
    CHECK(size(rig.hand.told.force) < 0.2);  // from zero
    rig.run(200, {0, 5, 0});
    CHECK(std::fabs(size(rig.hand.told.force) - 5) < 1e-3);
    rig.hand.grip = 0.2f;
    rig.run(10, {0, 5, 0});
    CHECK(size(rig.hand.told.force) == 0);
    CHECK(rig.safety().faults == 0);  // letting go is no fault
}

TEST_CASE("safety: the same exchanges give the same bits", "[safety]") {
    const auto run = [] {
        HandDeviceDef def;
        def.hand = {0.1, 1, 50};
        frm_device_safety_def limits;
        REQUIRE(frm_device_safety_def_init(&limits, sizeof limits) == FRM_OK);
        limits.deadline_ns = never;
        Rig rig(def, &limits);
        rig.hand.target = [](double t) { return Vec3d(0.05 * std::sin(20 * t), 0.02 * std::cos(31 * t), 0); };
        REQUIRE(frm_device_engage(rig.device) == FRM_OK);
        std::vector<frm_wrench> sent;
        frm_device_state state{};
        for (int i = 0; i < 1000; ++i) {
            const frm_vec3& v = state.twist.linear;
            state = rig.exchange({-40 * v.x, -40 * v.y, -40 * v.z});
            sent.push_back(rig.safety().sent);
        }
        return sent;
    };
    const auto first = run(), second = run();
    CHECK(std::memcmp(first.data(), second.data(), first.size() * sizeof first[0]) == 0);
}
