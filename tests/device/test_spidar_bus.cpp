// SPIDAR-G through the real libusb and hidapi, with simulated amplifiers on the bus: a shim's (usbfs_shim.cpp), or in a
// virtual machine the kernel's own (kernel_bus.h).
//
// Nothing here depends on how fast the machine is: deadlines are seconds where nothing is to go wrong.
#include <time.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/error.h"
#include "device/spidar_g/loaded_library.h"
#ifdef FRM_TEST_KERNEL
#include "tests/device/kernel_bus.h"
#else
#include "tests/device/usb_bus.h"
#endif
#include "tests/support/library.h"

using namespace frm::test;
using Json = nlohmann::json;

namespace {

/// The built-in device with patience: a busy machine may take seconds.
std::string configuration(const Folder& folder, const Json& change = Json::object()) {
    Json json = Json::parse(std::ifstream(FRM_TEST_SAMPLES "/devices/SpidarG6X3R.json"));
    json["timeout"] = 1.0;
    json["checks"] = {{"string_speed", 0.2}};
    json.merge_patch(change);
    const std::string path = folder.file("device.json");
    std::ofstream(path) << json;
    return path;
}

void wait_a_period(timespec& due) {
    due.tv_nsec += 1000000;
    if (due.tv_nsec >= 1000000000) due.tv_nsec -= 1000000000, ++due.tv_sec;
    clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
}

struct Opened {
    Opened(const Library& library, const std::string& path, int rotary = -1) {
        const frm_status status = frm_device_open_spidar_g(library.context, path.c_str(), rotary, &device);
        INFO(library.error());
        REQUIRE(status == FRM_OK);
        // The driver is what is looked at: a deadline of the safety layer's comes where a command names one, and poses that
        // a busy machine read late are no grip that runs away.
        frm_device_safety_def safety;
        REQUIRE(frm_device_safety_def_init(&safety, sizeof safety) == FRM_OK);
        safety.deadline_ns = 10'000'000'000;
        safety.ramp_time = 0.05f;
        safety.max_speed = 100, safety.max_spin = 1000;
        safety.passivity = 0;
        REQUIRE(frm_device_set_safety(device, &safety) == FRM_OK);
    }
    ~Opened() { frm_device_close(device); }

    /// Calibrated where the grip is, and engaged: without a fault from then on, and forces ramp up.
    void begin() const {
        REQUIRE(frm_device_clear_fault(device) == FRM_OK);
        REQUIRE(frm_device_calibrate(device) == FRM_OK);
        REQUIRE(frm_device_engage(device) == FRM_OK);
    }
    frm_device_safety_state safety() const {
        frm_device_safety_state state{};
        state.struct_size = sizeof state;
        REQUIRE(frm_device_get_safety(device, &state) == FRM_OK);
        return state;
    }

    frm_device_state exchange(float force = 0, std::uint64_t deadline_ns = 0) const {
        frm_device_state state{};
        state.struct_size = sizeof state;
        frm_device_command command{};
        command.struct_size = sizeof command;
        command.wrench.force.z = force;
        command.deadline_ns = deadline_ns;
        REQUIRE(frm_device_exchange(device, &command, &state) == FRM_OK);
        return state;
    }

    /// At 1 kHz, as the simulated hand lives in the machine's time.
    frm_device_state run(int cycles, float force, std::uint64_t deadline_ns = 0) const {
        frm_device_state state{};
        timespec due{};
        clock_gettime(CLOCK_MONOTONIC, &due);
        for (int k = 0; k < cycles; ++k) {
            wait_a_period(due);
            state = exchange(force, deadline_ns);
        }
        return state;
    }

    frm_device device = 0;
};

bool at_rest(const frm_shim_view& view) {
    return std::all_of(view.tensions, view.tensions + 8, [](double t) { return t < 0.31; });
}

/// Tensions that hold each other in balance: what a device that is well shows for no force.
bool shows_nothing(const frm_device_state& state) {
    const frm_vec3& f = state.achieved.force;
    return std::fabs(f.x) + std::fabs(f.y) + std::fabs(f.z) < 0.1;
}

void sleep_ms(long ms) {
    const timespec time{ms / 1000, ms % 1000 * 1000000};
    nanosleep(&time, nullptr);
}

#ifdef FRM_TEST_KERNEL
using Bus = KernelBus;
// Linux 6.1 of late 2026 drops a report that is shorter than its descriptor says; older ones hand it on.
constexpr std::uint32_t short_report = FRM_DEVICE_FAULT_SHORT_PACKET | FRM_DEVICE_FAULT_TIMEOUT;
#else
using Bus = UsbBus;
constexpr std::uint32_t short_report = FRM_DEVICE_FAULT_SHORT_PACKET;
#endif

const Json simple = {{"amplifier", "simple"}};
const Json hid = {{"amplifier", "simple"}, {"bus", "hid"}, {"vendor", "04D8"}, {"product", "003F"}};

}  // namespace

TEST_CASE("a library that is not installed is said to be missing", "[bus]") {
    try {
        const frm::spidar_g::LoadedLibrary library({"libfrm-is-not-there.so.7", "nor-is-this.so"}, "libsomething");
        FAIL("loaded");
    } catch (const frm::Error& e) {
        CHECK(e.status() == FRM_ERROR_UNSUPPORTED);
        CHECK(std::string(e.text()).find("libsomething is not installed") == 0);
    }
    const frm::spidar_g::LoadedLibrary library({"libfrm-is-not-there.so.7", "libusb-1.0.so.0"}, "libusb-1.0");
    void (*function)() = nullptr;
    CHECK_THROWS_AS(library.find("libusb_fly", function), frm::Error);
}

TEST_CASE("amplifiers on USB are found by their rotary switch", "[bus]") {
    Bus bus;
    const Folder folder;
    const Library library;
    const std::string path = configuration(folder);
    std::uint32_t count = 7;
    REQUIRE(frm_device_enumerate_spidar_g(library.context, path.c_str(), nullptr, 0, &count) == FRM_OK);
    CHECK(count == 0);
    frm_device device = 0;
    CHECK(frm_device_open_spidar_g(library.context, path.c_str(), -1, &device) == FRM_ERROR_DEVICE);
    CHECK(library.error().find("no SPIDAR-G") != std::string::npos);

    bus.plug_usb("sh4", 3), bus.plug_usb("sh4", 9), bus.plug_usb("simple", 5);
    frm_device_info list[4] = {};
    for (frm_device_info& i : list) i.struct_size = sizeof i;
    REQUIRE(frm_device_enumerate_spidar_g(library.context, path.c_str(), list, 4, &count) == FRM_OK);
    REQUIRE(count == 2);  // the Simple one is another product
    CHECK(list[0].serial == 3);
    CHECK(list[1].serial == 9);
    CHECK(std::string(list[0].name) == "SpidarG6X3R");
    {
        const Opened nine(library, path, 9);
        frm_device_info info{};
        info.struct_size = sizeof info;
        REQUIRE(frm_device_get_info(nine.device, &info) == FRM_OK);
        CHECK(info.serial == 9);
        CHECK(frm_device_open_spidar_g(library.context, path.c_str(), 9, &device) == FRM_ERROR_DEVICE);
        CHECK(library.error().find("rotary switch at 9") != std::string::npos);
        const Opened any(library, path);
        REQUIRE(frm_device_get_info(any.device, &info) == FRM_OK);
        CHECK(info.serial == 3);
    }
    const Opened again(library, path, 9);
    const Folder other;
    const Opened five(library, configuration(other, simple), 5);
    CHECK(five.exchange().status == FRM_DEVICE_UNCALIBRATED);
}

TEST_CASE("a force goes out and a motion comes back, by USB and by HID", "[bus]") {
    for (const int kind : {0, 1, 2}) {
        Bus bus;
        const Folder folder;
        const Library library;
        const std::string node = kind == 2 ? bus.plug_hid(4) : bus.plug_usb(kind == 1 ? "simple" : "sh4", 4);
        const Opened spidar(library, configuration(folder, kind == 0 ? Json::object() : kind == 1 ? simple : hid), 4);
        CHECK(spidar.exchange(5).faults == FRM_DEVICE_FAULT_UNCALIBRATED);
        CHECK(at_rest(bus.look(node)));
        spidar.begin();
        const std::uint64_t before = bus.look(node).cycles;
        const frm_device_state state = spidar.run(1000, 4);
        CHECK(bus.look(node).cycles >= before + 1000);  // the watchdog may have looked before the first
        CHECK(state.status == FRM_DEVICE_READY);
        CHECK(state.faults == 0);
        // Up is z here and y on the device; 4 N against the hand's 200 N/m.
        CHECK(std::fabs(state.pose.position.z - 0.02) < 0.002);
        CHECK(std::fabs(state.pose.position.z - bus.look(node).position[1]) < 0.0005);
        CHECK(std::fabs(state.achieved.force.z - 4) < 0.05);
        REQUIRE(frm_device_stop(spidar.device) == FRM_OK);
        CHECK(at_rest(bus.look(node)));
    }
}

TEST_CASE("a loop of 1 kHz through libusb", "[bus]") {
    Bus bus;
    const Folder folder;
    const Library library;
    const std::string node = bus.plug_usb("sh4", 0);
    const Opened spidar(library, configuration(folder));
    spidar.begin();
    std::vector<double> took;
    timespec due{};
    clock_gettime(CLOCK_MONOTONIC, &due);
    for (int k = 0; k < 1000; ++k) {
        wait_a_period(due);
        timespec start{}, end{};
        clock_gettime(CLOCK_MONOTONIC, &start);
        const frm_device_state state = spidar.exchange(2);
        clock_gettime(CLOCK_MONOTONIC, &end);
        REQUIRE(state.faults == 0);
        took.push_back(static_cast<double>(end.tv_sec - start.tv_sec) * 1e6 +
                       static_cast<double>(end.tv_nsec - start.tv_nsec) * 1e-3);
    }
    std::sort(took.begin(), took.end());
    // Printed, not judged: the machine may be busy.
    std::printf("an exchange through libusb: median %.1f us, 90 %% %.1f us, 99 %% %.1f us, longest %.1f us\n",
                took[500], took[900], took[990], took.back());
}

TEST_CASE("bus faults are named, latched, and gone after calibration", "[bus]") {
    const struct {
        int shim;
        std::uint32_t usb, hid;  ///< 0: HID has no such thing
    } cases[] = {{FRM_SHIM_SILENT, FRM_DEVICE_FAULT_TIMEOUT, FRM_DEVICE_FAULT_TIMEOUT},
                 {FRM_SHIM_STALL, FRM_DEVICE_FAULT_TRANSFER, 0},
                 {FRM_SHIM_SHORT, FRM_DEVICE_FAULT_SHORT_PACKET, short_report}};
    for (const bool by_hid : {false, true}) {
        for (const auto& c : cases) {
            const std::uint32_t expected = by_hid ? c.hid : c.usb;
            if (expected == 0) continue;
            Bus bus;
            const Folder folder;
            const Library library;
            const std::string node = by_hid ? bus.plug_hid(1) : bus.plug_usb("sh4", 1);
            Json change = by_hid ? hid : Json::object();
            change["timeout"] = 0.5;
            const Opened spidar(library, configuration(folder, change));
            spidar.begin();
            REQUIRE(spidar.run(200, 3).faults == 0);
            CHECK_FALSE(at_rest(bus.look(node)));
            bus.set_fault(node, c.shim);
            frm_device_state state = spidar.exchange(3);
            INFO((by_hid ? "HID" : "USB") << ", fault " << c.shim << ": faults " << state.faults);
            CHECK(state.status == FRM_DEVICE_FAULT);
            CHECK((state.faults & expected) != 0);
            CHECK((spidar.safety().faults & expected) != 0);
            CHECK(spidar.safety().engaged == 0);
            CHECK(at_rest(bus.look(node)));  // what goes out still arrives
            CHECK(frm_device_calibrate(spidar.device) == FRM_ERROR_DEVICE);
            bus.set_fault(node, FRM_SHIM_GOOD);
            CHECK((spidar.exchange(3).faults & expected) != 0);
            CHECK(at_rest(bus.look(node)));
            CHECK(frm_device_engage(spidar.device) == FRM_ERROR_STATE);
            bus.centre(node);
            REQUIRE(frm_device_calibrate(spidar.device) == FRM_OK);
            state = spidar.exchange(3);
            CHECK(state.status == FRM_DEVICE_FAULT);  // until somebody clears it
            CHECK(shows_nothing(state));
            bus.centre(node);
            spidar.begin();
            state = spidar.run(200, 3);
            CHECK(state.faults == 0);
            CHECK(std::fabs(state.achieved.force.z - 3) < 0.05);
        }
    }
}

TEST_CASE("an amplifier that is unplugged stays away until it is opened anew", "[bus]") {
    for (const bool by_hid : {false, true}) {
        Bus bus;
        const Folder folder;
        const Library library;
        const std::string node = by_hid ? bus.plug_hid(2) : bus.plug_usb("sh4", 2);
        const std::string path = configuration(folder, by_hid ? hid : Json::object());
        {
            const Opened spidar(library, path);
            spidar.begin();
            for (int k = 0; k < 20; ++k) REQUIRE(spidar.exchange(1).faults == 0);
            bus.set_fault(node, FRM_SHIM_GONE);
            for (int k = 0; k < 5; ++k) {
                const frm_device_state state = spidar.exchange(1);
                CHECK(state.status == FRM_DEVICE_FAULT);
                CHECK((state.faults & FRM_DEVICE_FAULT_UNPLUGGED) != 0);
            }
            CHECK(std::string(spidar.safety().reason) == "the device was unplugged");
            CHECK(frm_device_calibrate(spidar.device) == FRM_ERROR_DEVICE);
            CHECK(frm_device_stop(spidar.device) == FRM_OK);
        }
        frm_device device = 0;
        CHECK(frm_device_open_spidar_g(library.context, path.c_str(), -1, &device) == FRM_ERROR_DEVICE);
        CHECK(device == 0);
    }
}

#ifdef FRM_TEST_KERNEL
// The shim's unplugging is over when it returns; the kernel's comes at some moment of an exchange.
TEST_CASE("an amplifier that is unplugged in the middle of exchanges", "[bus]") {
    for (const bool by_hid : {false, true}) {
        Bus bus;
        const Folder folder;
        const Library library;
        const std::string node = by_hid ? bus.plug_hid(2) : bus.plug_usb("sh4", 2);
        const Opened spidar(library, configuration(folder, by_hid ? hid : Json::object()));
        spidar.begin();
        REQUIRE(spidar.run(100, 1).faults == 0);
        std::thread hand([&] {
            sleep_ms(30);
            bus.pull(node);
        });
        frm_device_state state{};
        int bad = 0, good_again = 0;
        for (int k = 0; k < 100000 && (state.faults & FRM_DEVICE_FAULT_UNPLUGGED) == 0; ++k) {
            state = spidar.exchange(1);
            bad += state.status == FRM_DEVICE_FAULT;
            good_again += bad > 0 && state.status != FRM_DEVICE_FAULT;
        }
        hand.join();
        CHECK((state.faults & FRM_DEVICE_FAULT_UNPLUGGED) != 0);
        CHECK(good_again == 0);
        CHECK(shows_nothing(spidar.exchange(1)));
        CHECK(spidar.safety().engaged == 0);
        CHECK((spidar.safety().faults & FRM_DEVICE_FAULT_UNPLUGGED) != 0);
    }
}
#endif

TEST_CASE("without exchanges the strings rest after the deadline", "[bus]") {
    Bus bus;
    const Folder folder;
    const Library library;
    const std::string node = bus.plug_usb("sh4", 6);
    const Opened spidar(library, configuration(folder));
    spidar.begin();
    spidar.run(200, 3);
    CHECK_FALSE(at_rest(bus.look(node)));
    spidar.exchange(3, 30000000);
    for (int k = 0; k < 1000 && !at_rest(bus.look(node)); ++k) sleep_ms(10);
    CHECK(at_rest(bus.look(node)));
    const std::uint64_t resting = bus.look(node).cycles;
    for (int k = 0; k < 1000 && bus.look(node).cycles < resting + 3; ++k) sleep_ms(10);
    CHECK(bus.look(node).cycles >= resting + 3);  // its counters are still followed
    const frm_device_state late = spidar.exchange(3);
    CHECK(late.status == FRM_DEVICE_FAULT);
    CHECK(shows_nothing(late));
    CHECK(std::string(spidar.safety().reason) == "no exchange came before the deadline");
    // It is still calibrated. What was late before is no fault of what comes now.
    spidar.exchange(3, 1);
    sleep_ms(50);
    REQUIRE(frm_device_clear_fault(spidar.device) == FRM_OK);
    REQUIRE(frm_device_engage(spidar.device) == FRM_OK);
    const frm_device_state later = spidar.run(400, 3);
    CHECK(later.status == FRM_DEVICE_READY);
    CHECK(later.faults == 0);
    CHECK(std::fabs(later.achieved.force.z - 3) < 0.05);
    REQUIRE(frm_device_stop(spidar.device) == FRM_OK);
    CHECK(at_rest(bus.look(node)));
}

TEST_CASE("counters are followed between calibration and the first exchange, and after a stop", "[bus]") {
    Bus bus;
    const Folder folder;
    const Library library;
    bus.plug_usb("sh4", 6);
    // They count as lost after 0.27 s.
    const Opened spidar(library, configuration(folder, {{"checks", {{"string_speed", 2}}}}));
    const auto pause_is_well = [&](bool stopped) {
        REQUIRE(frm_device_calibrate(spidar.device) == FRM_OK);
        if (stopped) {
            spidar.exchange();
            REQUIRE(frm_device_stop(spidar.device) == FRM_OK);
        }
        sleep_ms(600);
        return spidar.exchange().faults == 0;
    };
    // Nobody says that this machine lets a thread run in time; but hardly five times in a row.
    for (const bool stopped : {false, true}) {
        bool well = false;
        for (int k = 0; k < 5 && !well; ++k) well = pause_is_well(stopped);
        CHECK(well);
    }
}
