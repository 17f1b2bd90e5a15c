// The simulated SPIDAR-G under a servo, with a world, a recorder and the safety layer: what each of them was tested for alone,
// together. Faults are provoked from the servo's own thread at a tick, so nothing here depends on the clock.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "device/simulated/simulated_transport.h"
#include "device/spidar_g/driver.h"
#include "tests/support/library.h"

using namespace frm;
using namespace frm::test;
using frm::spidar_g::Carried;
using Json = nlohmann::json;

namespace {

/// What the driver gave in each exchange.
struct Heard {
    frm_device_state state;
    std::vector<std::uint8_t> packet;
};

/// One simulated SPIDAR-G whose hand leads it on an ellipse, a box under water, and a servo between them.
struct Rig {
    Rig() {
        REQUIRE(frm_world_create(lib.context, nullptr, &world) == FRM_OK);
        frm_water_def water_def;
        REQUIRE(frm_water_def_init(&water_def, sizeof water_def) == FRM_OK);
        water_def.nx = water_def.ny = 48;
        frm_water water = 0;
        REQUIRE(frm_water_create(world, &water_def, &water) == FRM_OK);
        frm_body_def body_def;
        REQUIRE(frm_body_def_init(&body_def, sizeof body_def) == FRM_OK);
        body_def.map = lib.map();
        REQUIRE(frm_body_create(world, &body_def, &body) == FRM_OK);
        Json json = Json::parse(std::ifstream(FRM_TEST_SAMPLES "/devices/SpidarG6X3R.json"));
        json["hand"] = {{"stiffness", 2000},           {"damping", 30},
                        {"turning_stiffness", 3},      {"sine", {0.02, 0.01, 0.02}},
                        {"turning", {0.2, 0.3, -0.1}}, {"frequency", 2}};
        std::ofstream(folder.file("device.json")) << json;
        open();
    }
    ~Rig() {
        if (servo) frm_servo_destroy(servo);
        if (device) frm_device_close(device);
    }

    void open() {
        const std::string path = folder.file("device.json");
        spidar_g::Source source{path.c_str(), -1, FRM_AXES_Z_UP_RIGHT, true, &simulation};
        frm_device_driver driver = spidar_g::driver();
        driver.exchange = listen;
        heard_by = this;
        REQUIRE(frm_device_open(lib.context, &driver, &source, 0, &device) == FRM_OK);
        frm_device_safety_def safety;
        REQUIRE(frm_device_safety_def_init(&safety, sizeof safety) == FRM_OK);
        safety.deadline_ns = 10'000'000'000;  // a busy machine is no stalled host
        safety.ramp_time = 0.05f;
        // Put back to the centre, the grip snaps to where the hand leads.
        safety.max_speed = 30, safety.max_spin = 300;
        REQUIRE(frm_device_set_safety(device, &safety) == FRM_OK);
        REQUIRE(frm_device_calibrate(device) == FRM_OK);
        frm_servo_def def;
        REQUIRE(frm_servo_def_init(&def, sizeof def) == FRM_OK);
        def.device = device;
        def.body = body;
        def.lock_memory = 0;
        def.on_tick = on_tick;
        def.user = this;
        REQUIRE(frm_servo_create(lib.context, &def, &servo) == FRM_OK);
        frm_servo_input input;
        REQUIRE(frm_servo_input_init(&input, sizeof input) == FRM_OK);
        input.anchor.position = {0, 0, -0.05};  // all of the box is under water, nearly
        input.force_scale = 0.1f;
        REQUIRE(frm_servo_set_input(servo, &input) == FRM_OK);
    }

    /// Engaged, for so many ticks; `at` is called on the servo's thread before each.
    void run(std::uint64_t ticks, std::function<void(std::uint64_t)> at = {}) {
        last_ = ticks;
        at_ = std::move(at);
        REQUIRE(frm_servo_engage(servo) == FRM_OK);
        REQUIRE(frm_servo_start(servo) == FRM_OK);
        while (state().running) std::this_thread::sleep_for(std::chrono::milliseconds(1));
        CHECK(state().status == FRM_ERROR_END);
        CHECK(state().ticks == ticks);
    }
    frm_servo_state state() const {
        frm_servo_state s{};
        s.struct_size = sizeof s;
        REQUIRE(frm_servo_get_state(servo, &s) == FRM_OK);
        return s;
    }
    double tightest() const {
        const auto& tensions = simulation->amplifier().tensions();
        return *std::max_element(tensions.begin(), tensions.end());
    }
    simulated::HandOnStrings& hand() const { return simulation->amplifier().hand(); }

    static frm_status FRM_CALL on_tick(void* user, std::uint64_t tick, float) {
        Rig& rig = *static_cast<Rig*>(user);
        if (rig.at_) rig.at_(tick);
        return tick < rig.last_ ? FRM_OK : FRM_ERROR_END;
    }
    static frm_status FRM_CALL listen(void* user, void* instance, const frm_device_command* command,
                                      frm_device_state* state) {
        const frm_status status = spidar_g::driver().exchange(user, instance, command, state);
        std::uint8_t packet[512];
        std::uint32_t size = 0;
        if (heard_by->listens && spidar_g::driver().raw(user, instance, packet, sizeof packet, &size) == FRM_OK)
            heard_by->heard.push_back({*state, {packet, packet + size}});
        return status;
    }

    static inline Rig* heard_by = nullptr;
    Library lib;
    Folder folder;
    simulated::SimulatedTransport* simulation = nullptr;
    frm_world world = 0;
    frm_body body = 0;
    frm_device device = 0;
    frm_servo servo = 0;
    bool listens = false;
    std::vector<Heard> heard;

private:
    std::uint64_t last_ = 0;
    std::function<void(std::uint64_t)> at_;
};

double size(const frm_vec3& v) { return std::sqrt(static_cast<double>(v.x * v.x + v.y * v.y + v.z * v.z)); }

}  // namespace

TEST_CASE("a simulated SPIDAR-G under a servo is recorded and replayed", "[sim_servo]") {
    Rig rig;
    const std::string path = rig.folder.file("session.frmrec");
    frm_recorder_def def;
    REQUIRE(frm_recorder_def_init(&def, sizeof def) == FRM_OK);
    def.waits = 1;
    def.force_interval = 16;
    frm_recorder recorder = 0;
    REQUIRE(frm_recorder_create(rig.world, path.c_str(), &def, &recorder) == FRM_OK);
    REQUIRE(frm_recorder_add_device(recorder, rig.device) == FRM_OK);
    rig.listens = true;
    double felt = 0, moved = 0;
    rig.run(600, [&](std::uint64_t) {
        felt = std::max(felt, rig.tightest());
        moved = std::max(moved, length(rig.hand().pose().position));
    });
    const frm_servo_state last = rig.state();
    CHECK(last.faults == 0);
    CHECK(last.device_status == FRM_DEVICE_READY);
    CHECK(last.wrench.force.z > 1);  // a box under water is lifted
    CHECK(felt > 1);                 // and strings pull for it: the least tension is 0.3 N
    CHECK(moved > 0.01);
    REQUIRE(frm_servo_destroy(rig.servo) == FRM_OK);
    rig.servo = 0;
    CHECK(rig.tightest() < 0.31);
    REQUIRE(frm_recorder_close(recorder) == FRM_OK);

    const Library lib;
    frm_replay replay = 0;
    REQUIRE(frm_replay_open(lib.context, path.c_str(), &replay) == FRM_OK);
    for (int i = 0; i < 600; ++i) {
        frm_replay_step_result result{};
        result.struct_size = sizeof result;
        REQUIRE(frm_replay_step(replay, &result) == FRM_OK);
        REQUIRE(result.diverged == 0);
    }
    frm_device again = 0;
    REQUIRE(frm_device_open_replay(lib.context, path.c_str(), 0, &again) == FRM_OK);
    REQUIRE(rig.heard.size() == 601);  // the one after the last tick ended the servo
    for (const Heard& h : rig.heard) {
        frm_device_state state{};
        state.struct_size = sizeof state;
        REQUIRE(frm_device_exchange(again, nullptr, &state) == FRM_OK);
        REQUIRE(std::memcmp(&state.pose, &h.state.pose, sizeof state.pose) == 0);
        REQUIRE(std::memcmp(&state.twist, &h.state.twist, sizeof state.twist) == 0);
        REQUIRE(state.faults == h.state.faults);
        REQUIRE(state.time_ns == h.state.time_ns);
        REQUIRE(state.sequence == h.state.sequence);
        std::uint8_t packet[512];
        std::uint32_t size = 0;
        REQUIRE(frm_device_get_raw(again, packet, sizeof packet, &size) == FRM_OK);
        REQUIRE(size > 0);
        REQUIRE(std::vector<std::uint8_t>(packet, packet + size) == h.packet);
    }
}

TEST_CASE("what goes wrong with a simulated SPIDAR-G ends in least tensions, until all is begun anew", "[sim_servo]") {
    constexpr std::uint32_t strings =
        FRM_DEVICE_FAULT_STUCK_ENCODER | FRM_DEVICE_FAULT_SLACK_STRING | FRM_DEVICE_FAULT_BROKEN_STRING;
    const struct {
        const char* name;
        std::function<void(Rig&)> happens;
        std::uint32_t faults;  ///< one of these
        const char* reason;
    } cases[] = {
        {"stuck encoder", [](Rig& r) { r.hand().faults.stuck = 2; }, strings, "an encoder is stuck"},
        {"broken string", [](Rig& r) { r.hand().faults.broken = 5; }, strings, "a string is broken"},
        {"slack string", [](Rig& r) { r.hand().faults.slack = 3; }, strings, "a string is slack"},
        {"short packet", [](Rig& r) { r.simulation->failing = Carried::cut_off; }, FRM_DEVICE_FAULT_SHORT_PACKET,
         "the device sent a packet that is too short"},
        {"no answer", [](Rig& r) { r.simulation->failing = Carried::too_late; }, FRM_DEVICE_FAULT_TIMEOUT,
         "the device did not answer in time"},
        {"refused", [](Rig& r) { r.simulation->failing = Carried::refused; }, FRM_DEVICE_FAULT_TRANSFER,
         "the bus refused a transfer, or the device answered what cannot be"},
        {"lost counts", [](Rig& r) { r.simulation->lose(60); }, FRM_DEVICE_FAULT_LOST_COUNT,
         "the encoders may have wrapped unseen: calibrate the device"},
        {"unplugged", [](Rig& r) { r.simulation->failing = Carried::unplugged; }, FRM_DEVICE_FAULT_UNPLUGGED,
         "the device was unplugged"},
    };
    int named = 0;
    for (const auto& c : cases) {
        INFO(c.name);
        Rig rig;
        const bool gone = c.faults == FRM_DEVICE_FAULT_UNPLUGGED;
        const bool refuses = gone || c.faults == FRM_DEVICE_FAULT_TRANSFER;
        double before = 0;
        rig.run(300, [&](std::uint64_t tick) {
            if (tick < 120) before = std::max(before, rig.tightest());
            if (tick == 120) c.happens(rig);
        });
        CHECK(before > 1);
        frm_servo_state s = rig.state();
        CHECK((s.faults & c.faults) != 0);
        INFO(s.reason);
        // Eight lengths cannot always tell what is wrong with which string (docs/devices.md), but that something is.
        if (c.faults != strings) CHECK(std::string(s.reason) == c.reason);
        named += std::string(s.reason) == c.reason;
        CHECK(s.engaged == 0);
        CHECK(s.device_status == FRM_DEVICE_FAULT);
        CHECK(size(s.displayed.force) < 1);  // what the least tensions make: nothing, where the grip is at the centre
        // Nothing can be told to what takes nothing: a real amplifier has a watchdog of its own for that.
        CHECK((refuses || rig.tightest() < 0.31));

        // It does not come back by itself, also when its cause is gone.
        rig.simulation->failing = Carried::whole;
        rig.hand().faults = {};
        rig.run(20);
        s = rig.state();
        CHECK(s.engaged == 0);
        CHECK(s.faults != 0);
        CHECK((gone || rig.tightest() < 0.31));
        CHECK(frm_device_engage(rig.device) == FRM_ERROR_STATE);

        if (gone) {
            CHECK(frm_device_calibrate(rig.device) == FRM_ERROR_DEVICE);
            REQUIRE(frm_servo_destroy(rig.servo) == FRM_OK);
            REQUIRE(frm_device_close(rig.device) == FRM_OK);
            rig.servo = rig.device = 0;
            rig.open();
        } else {
            REQUIRE(frm_device_clear_fault(rig.device) == FRM_OK);
            rig.hand().place({});
            REQUIRE(frm_device_calibrate(rig.device) == FRM_OK);
        }
        double first = 1e9, after = 0;
        rig.run(150, [&](std::uint64_t tick) {
            if (tick < 2) first = rig.tightest();
            after = std::max(after, rig.tightest());
        });
        s = rig.state();
        CHECK(s.engaged == 1);
        CHECK(s.faults == 0);
        CHECK(s.ramp == 1);
        CHECK(first < 0.5);  // from nothing
        CHECK(after > 1);
    }
    CHECK(named >= 7);
}
