#include <cmath>

#include "tests/support/library.h"

using frm::test::Folder;
using frm::test::Library;
using namespace frm;

namespace {

/// A driver of a host's own: a grip that runs in circles and remembers what it was told.
struct Circling {
    std::uint64_t cycles = 0;
    frm_wrench told{};
    bool open = false, stopped = false, bad = false;
};

frm_status FRM_CALL enumerate(void*, frm_device_info* list, std::uint32_t capacity, std::uint32_t* count) {
    *count = 2;
    for (std::uint32_t i = 0; list && i < capacity && i < 2; ++i) list[i].serial = 100 + i;
    return FRM_OK;
}
frm_status FRM_CALL open(void* user, std::uint32_t index, void** instance) {
    if (index > 1) return FRM_ERROR_ARGUMENT;
    static_cast<Circling*>(user)->open = true;
    *instance = user;
    return FRM_OK;
}
frm_status FRM_CALL close(void*, void* instance) {
    static_cast<Circling*>(instance)->open = false;
    return FRM_OK;
}
frm_status FRM_CALL info(void*, void*, frm_device_info* out) {
    out->max_force = 20;
    out->name[0] = 'C';
    return FRM_OK;
}
frm_status FRM_CALL calibrate(void*, void*) { return FRM_OK; }
frm_status FRM_CALL exchange(void*, void* instance, const frm_device_command* command, frm_device_state* state) {
    auto& device = *static_cast<Circling*>(instance);
    device.told = command->wrench;
    const double phase = 0.01 * static_cast<double>(device.cycles);
    state->pose.position = {std::cos(phase), std::sin(phase), device.bad ? NAN : 0.0};
    state->twist.linear = {static_cast<float>(-std::sin(phase)), static_cast<float>(std::cos(phase)), 0};
    state->grip = 0.25f;
    state->buttons = 5;
    state->sequence = device.cycles;
    state->time_ns = 1000000 * device.cycles++;
    return FRM_OK;
}
frm_status FRM_CALL stop(void*, void* instance) {
    static_cast<Circling*>(instance)->stopped = true;
    return FRM_OK;
}

const frm_device_driver driver{sizeof driver, 0, enumerate, open, close, info, calibrate, exchange, stop, nullptr};

frm_device_state exchanged(frm_device device, frm_status expected = FRM_OK) {
    frm_device_state state{};
    state.struct_size = sizeof state;
    REQUIRE(frm_device_exchange(device, nullptr, &state) == expected);
    return state;
}

}  // namespace

TEST_CASE("the null device is there without being there", "[device]") {
    const Library lib;
    frm_device device = 0;
    REQUIRE(frm_device_open_null(lib.context, &device) == FRM_OK);
    const frm_device_state first = exchanged(device), second = exchanged(device);
    CHECK(first.status == FRM_DEVICE_READY);
    CHECK(first.pose.rotation.w == 1);
    CHECK(second.sequence == first.sequence + 1);
    CHECK(second.time_ns == first.time_ns + 2000000);
    frm_device_info i{};
    i.struct_size = sizeof i;
    REQUIRE(frm_device_get_info(device, &i) == FRM_OK);
    CHECK(std::string(i.name) == "null");
}

TEST_CASE("a host's own driver is driven, and closed with its context", "[device]") {
    Circling circling;
    {
        const Library lib;
        std::uint32_t count = 0;
        frm_device_info list[1] = {};
        list[0].struct_size = sizeof list[0];
        REQUIRE(frm_device_enumerate(lib.context, &driver, &circling, list, 1, &count) == FRM_OK);
        CHECK(count == 2);
        CHECK(list[0].serial == 100);
        frm_device device = 0;
        CHECK(frm_device_open(lib.context, &driver, &circling, 7, &device) == FRM_ERROR_DEVICE);
        REQUIRE(frm_device_open(lib.context, &driver, &circling, 1, &device) == FRM_OK);
        CHECK(circling.open);
        frm_device_command command{};
        command.struct_size = sizeof command;
        command.wrench.force.y = -3;
        frm_device_state state{};
        state.struct_size = sizeof state;
        REQUIRE(frm_device_exchange(device, &command, &state) == FRM_OK);
        CHECK(circling.told.force.y == 0);  // it is not engaged: test_safety.cpp
        CHECK(state.pose.position.x == 1);
        CHECK(state.buttons == 5);
        command.wrench.torque.x = INFINITY;
        CHECK(frm_device_exchange(device, &command, &state) == FRM_ERROR_ARGUMENT);
        CHECK(circling.cycles == 1);
        CHECK_FALSE(circling.stopped);
        circling.bad = true;
        CHECK(frm_device_exchange(device, nullptr, &state) == FRM_ERROR_DEVICE);
        CHECK(circling.stopped);
    }
    CHECK_FALSE(circling.open);
}

TEST_CASE("a recorded device moves again as it did", "[device]") {
    const Folder folder;
    const std::string path = folder.file("device.frmrec");
    std::vector<frm_device_state> seen;
    {
        const Library lib;
        Circling circling;
        frm_world world = 0;
        frm_recorder recorder = 0;
        frm_device device = 0, other = 0;
        REQUIRE(frm_world_create(lib.context, nullptr, &world) == FRM_OK);
        REQUIRE(frm_recorder_create(world, path.c_str(), nullptr, &recorder) == FRM_OK);
        REQUIRE(frm_device_open_null(lib.context, &other) == FRM_OK);
        REQUIRE(frm_device_open(lib.context, &driver, &circling, 0, &device) == FRM_OK);
        REQUIRE(frm_recorder_add_device(recorder, other) == FRM_OK);
        REQUIRE(frm_recorder_add_device(recorder, device) == FRM_OK);
        CHECK(frm_recorder_add_device(recorder, device) == FRM_ERROR_STATE);
        for (int t = 0; t < 100; ++t) {
            exchanged(other);
            seen.push_back(exchanged(device));
            REQUIRE(frm_world_tick(world, 0.002f) == FRM_OK);
        }
        REQUIRE(frm_device_close(device) == FRM_OK);  // before its recorder
        REQUIRE(frm_recorder_close(recorder) == FRM_OK);
    }
    const Library lib;
    frm_device device = 0;
    REQUIRE(frm_device_open_replay(lib.context, path.c_str(), 1, &device) == FRM_OK);
    frm_device_info i{};
    i.struct_size = sizeof i;
    REQUIRE(frm_device_get_info(device, &i) == FRM_OK);
    CHECK(i.max_force == 20);
    for (const frm_device_state& then : seen) {
        const frm_device_state now = exchanged(device);
        REQUIRE(std::memcmp(&now, &then, sizeof now) == 0);
    }
    exchanged(device, FRM_ERROR_END);
    frm_device missing = 0;
    CHECK(frm_device_open_replay(lib.context, path.c_str(), 2, &missing) == FRM_ERROR_STATE);
    CHECK(lib.error().find("holds 2 devices") != std::string::npos);

    // Another host's axes would move it elsewhere.
    frm_context_def def;
    frm_context_def_init(&def, sizeof def);
    def.axes = FRM_AXES_Y_UP_LEFT;
    frm_context unity = 0;
    REQUIRE(frm_context_create(&def, &unity) == FRM_OK);
    CHECK(frm_device_open_replay(unity, path.c_str(), 1, &missing) == FRM_ERROR_STATE);
    frm_context_destroy(unity);
}
