// The recorder beside the thread that ticks: what is lost and said, what a killed process leaves, packets, seeking.
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <iterator>
#include <random>
#include <thread>

#include "device/recording.h"
#include "tests/support/library.h"

using namespace frm;
using test::Folder;
using test::Library;

namespace {

/// A device whose packet counts, and whose grip goes round.
struct Counting {
    std::uint32_t cycles = 0;
};
frm_status FRM_CALL enumerate(void*, frm_device_info*, std::uint32_t, std::uint32_t* count) {
    *count = 1;
    return FRM_OK;
}
frm_status FRM_CALL open(void* user, std::uint32_t, void** instance) {
    *instance = user;
    return FRM_OK;
}
frm_status FRM_CALL nothing(void*, void*) { return FRM_OK; }
frm_status FRM_CALL info(void*, void*, frm_device_info*) { return FRM_OK; }
frm_status FRM_CALL exchange(void*, void* instance, const frm_device_command*, frm_device_state* state) {
    const double phase = 0.01 * ++static_cast<Counting*>(instance)->cycles;
    state->pose.position = {std::cos(phase), std::sin(phase), 0};
    return FRM_OK;
}
frm_status FRM_CALL raw(void*, void* instance, std::uint8_t* data, std::uint32_t capacity, std::uint32_t* size) {
    const std::uint32_t cycles = static_cast<Counting*>(instance)->cycles;
    *size = cycles % 7 == 0 ? 0 : 1 + cycles % 512;
    if (*size > capacity) return FRM_ERROR_CAPACITY;
    for (std::uint32_t i = 0; i < *size; ++i)
        data[i] = static_cast<std::uint8_t>(i == 0 ? cycles : i / 16 * cycles / 8);
    return FRM_OK;
}
const frm_device_driver driver{sizeof driver, 0, enumerate, open, nothing, info, nothing, exchange, nothing, raw};

struct Scene {
    explicit Scene(const std::string& path, std::uint32_t queue_bytes = 1 << 22, bool waits = false,
                   std::uint32_t force_interval = 1) {
        REQUIRE(frm_world_create(lib.context, nullptr, &world) == FRM_OK);
        frm_body_def body_def;
        frm_body_def_init(&body_def, sizeof body_def);
        body_def.map = lib.map();
        body_def.mass = 1;
        REQUIRE(frm_body_create(world, &body_def, &body) == FRM_OK);
        body_def.pose.position.x = 0.75;
        REQUIRE(frm_body_create(world, &body_def, &resting) == FRM_OK);
        frm_recorder_def def;
        frm_recorder_def_init(&def, sizeof def);
        def.queue_bytes = queue_bytes, def.waits = waits, def.force_interval = force_interval;
        REQUIRE(frm_recorder_create(world, path.c_str(), &def, &recorder) == FRM_OK);
    }
    void move(int t, frm_body which) {
        const frm_pose pose{{0.001 * t, which == resting ? 0.5 : 0.0, 0.05 * std::sin(0.1 * t)}, {0, 0, 0, 1}};
        REQUIRE(frm_body_set_motion(which, &pose, nullptr) == FRM_OK);
    }
    void tick(int t, float dt = 0.002f) {
        move(t, body);
        REQUIRE(frm_world_tick(world, dt) == FRM_OK);
    }
    frm_recorder_stats stats() const {
        frm_recorder_stats out{};
        out.struct_size = sizeof out;
        REQUIRE(frm_recorder_get_stats(recorder, &out) == FRM_OK);
        return out;
    }

    Library lib;
    frm_world world = 0;
    frm_body body = 0, resting = 0;
    frm_recorder recorder = 0;
};

/// Ticks that a replay finds the same; how it ended is checked.
frm_replay_info replay_same(const std::string& path) {
    const Library lib;
    frm_replay r = 0;
    INFO(path);
    REQUIRE(frm_replay_open(lib.context, path.c_str(), &r) == FRM_OK);
    frm_replay_info info{};
    info.struct_size = sizeof info;
    REQUIRE(frm_replay_get_info(r, &info) == FRM_OK);
    frm_replay_step_result result{};
    result.struct_size = sizeof result;
    std::uint64_t ticks = 0;
    frm_status status = FRM_OK;
    while ((status = frm_replay_step(r, &result)) == FRM_OK) {
        REQUIRE_FALSE(result.diverged);
        ++ticks;
    }
    REQUIRE(status == FRM_ERROR_END);
    REQUIRE(ticks == info.ticks);
    return info;
}

}  // namespace

TEST_CASE("what has no room is lost, counted, said, and ends a replay", "[recorder]") {
    const Folder folder;
    const std::string path = folder.file("lossy.frmrec");
    Scene scene(path, 1 << 16);
    int t = 0;
    while (scene.stats().lost_events == 0) scene.tick(++t);
    for (int k = 0; k < 50; ++k) scene.tick(++t);  // some of which come after the gap
    CHECK(frm_recorder_close(scene.recorder) == FRM_ERROR_CAPACITY);
    CHECK(scene.lib.error().find("lost") != std::string::npos);
    const frm_replay_info info = replay_same(path);
    CHECK(info.lost_events > 0);
    CHECK(info.ticks > 0);
    CHECK(info.ticks < static_cast<std::uint64_t>(t));
    CHECK(info.torn == 0);
}

TEST_CASE("a recorder that waits loses nothing", "[recorder]") {
    const Folder folder;
    const std::string path = folder.file("whole.frmrec");
    Scene scene(path, 1 << 16, true);
    for (int t = 1; t <= 3000; ++t) scene.tick(t);
    CHECK(scene.stats().lost_events == 0);
    REQUIRE(frm_recorder_close(scene.recorder) == FRM_OK);
    const frm_replay_info info = replay_same(path);
    CHECK(info.ticks == 3000);
    CHECK(info.lost_events == 0);
}

TEST_CASE("a killed process loses at most its last frame", "[recorder]") {
    const Folder folder;
    struct Shared {
        std::atomic<std::uint64_t> taken;
    };
    auto* const shared =
        static_cast<Shared*>(mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0));
    REQUIRE(shared != MAP_FAILED);
    std::mt19937 random(11);
    std::uint64_t most = 0;
    for (int kill_number = 0; kill_number < 25; ++kill_number) {
        const std::string path = folder.file("killed.frmrec");
        shared->taken = 0;
        const pid_t child = fork();
        REQUIRE(child >= 0);
        if (child == 0) {
            // No more than the queue takes ahead of the writer, which is what a host at its rate does.
            Scene scene(path);
            for (int t = 1;; ++t) {
                scene.tick(t);
                shared->taken = scene.stats().ticks;
                while (static_cast<std::uint64_t>(t) > shared->taken + 2000) {
                    usleep(100);
                    shared->taken = scene.stats().ticks;
                }
            }
        }
        const std::uint64_t wait_for = 1 + random() % 3000;
        while (shared->taken < wait_for) usleep(50);
        usleep(static_cast<useconds_t>(random() % 3000));
        REQUIRE(kill(child, SIGKILL) == 0);
        int status = 0;
        REQUIRE(waitpid(child, &status, 0) == child);
        const std::uint64_t taken = shared->taken;
        const frm_replay_info info = replay_same(path + ".part");
        CHECK(info.torn == 1);
        // A frame is 40 ms: 20 of these ticks. The tick that was being taken may not be in one yet.
        CHECK(info.ticks + 21 >= taken);
        most = std::max(most, info.ticks);
    }
    CHECK(most > 20);
    munmap(shared, sizeof(Shared));
}

TEST_CASE("packets are recorded byte for byte, wrenches as often as asked", "[recorder]") {
    const Folder folder;
    for (const std::uint32_t interval : {1u, 16u}) {
        const std::string path = folder.file("device.frmrec");
        std::vector<frm_device_state> states;
        std::vector<std::vector<std::uint8_t>> packets;
        const auto packet_of = [](frm_device device) {
            std::uint8_t data[512];
            std::uint32_t size = 0;
            REQUIRE(frm_device_get_raw(device, data, sizeof data, &size) == FRM_OK);
            return std::vector<std::uint8_t>(data, data + size);
        };
        {
            Scene scene(path, 1 << 22, false, interval);
            Counting counting;
            frm_device device = 0;
            REQUIRE(frm_device_open(scene.lib.context, &driver, &counting, 0, &device) == FRM_OK);
            REQUIRE(frm_recorder_add_device(scene.recorder, device) == FRM_OK);
            for (int t = 1; t <= 200; ++t) {
                frm_device_command command{};
                command.struct_size = sizeof command;
                command.wrench.force.x = 0.37f * static_cast<float>(t);
                frm_device_state state{};
                state.struct_size = sizeof state;
                REQUIRE(frm_device_exchange(device, &command, &state) == FRM_OK);
                states.push_back(state), packets.push_back(packet_of(device));
                scene.tick(t);
            }
            REQUIRE(frm_device_close(device) == FRM_OK);
            REQUIRE(frm_recorder_close(scene.recorder) == FRM_OK);
        }
        CHECK(replay_same(path).ticks == 200);
        const Library lib;
        frm_device device = 0;
        REQUIRE(frm_device_open_replay(lib.context, path.c_str(), 0, &device) == FRM_OK);
        CHECK(packet_of(device).empty());  // before the first exchange
        for (std::size_t i = 0; i < states.size(); ++i) {
            frm_device_state state{};
            state.struct_size = sizeof state;
            REQUIRE(frm_device_exchange(device, nullptr, &state) == FRM_OK);
            REQUIRE(std::memcmp(&state, &states[i], 96) == 0);
            REQUIRE(packet_of(device) == packets[i]);
        }
        device::RecordingReader reader(path.c_str());
        device::Event e;
        std::uint32_t n = 0;
        while (reader.next(e))
            if (const auto* x = std::get_if<device::event::Exchange>(&e)) {
                REQUIRE(x->has_wrenches == (n % interval == 0));
                REQUIRE(x->command.force.x == (x->has_wrenches ? 0.37f * static_cast<float>(n + 1) : 0.0f));
                ++n;
            }
        CHECK(n == 200);
    }
}

TEST_CASE("a check finds the tick that differs where no forces were kept, a tolerance passes what is near",
          "[recorder]") {
    const Folder folder;
    const std::string path = folder.file("good.frmrec"), bad = folder.file("bad.frmrec");
    {
        Scene scene(path, 1 << 22, false, 8);
        for (int t = 1; t <= 100; ++t) scene.tick(t);
        REQUIRE(frm_recorder_close(scene.recorder) == FRM_OK);
    }
    const auto rewrite = [&](auto&& change) {
        device::RecordingReader reader(path.c_str());
        device::RecordingWriter writer(bad.c_str());
        device::Event e;
        while (reader.next(e)) {
            if (auto* tick = std::get_if<device::event::Tick>(&e)) change(*tick);
            writer.write(e);
        }
        writer.close();
    };
    const auto first_difference = [&](const frm_replay_tolerance& tolerance) {
        const Library lib;
        frm_replay r = 0;
        REQUIRE(frm_replay_open(lib.context, bad.c_str(), &r) == FRM_OK);
        REQUIRE(frm_replay_set_tolerance(r, &tolerance) == FRM_OK);
        frm_replay_step_result result{};
        result.struct_size = sizeof result;
        while (frm_replay_step(r, &result) == FRM_OK)
            if (result.diverged) return result;
        return frm_replay_step_result{};
    };
    rewrite([](device::event::Tick& tick) {
        if (tick.tick == 37) tick.checks[1] ^= 0x100;
    });
    const frm_replay_step_result checked = first_difference({sizeof(frm_replay_tolerance), 0, 0, 0});
    CHECK(checked.tick == 37);
    CHECK(checked.body == 1);
    CHECK(checked.part == FRM_PART_PRESSURE);
    CHECK(std::isnan(checked.recorded));
    float before = 0;
    rewrite([&](device::event::Tick& tick) {
        if (tick.tick != 40) return;
        REQUIRE(tick.forces.size() == 2);
        before = tick.forces[0].buoyancy.force.z;
        tick.forces[0].buoyancy.force.z += 0.01f;
    });
    const frm_replay_step_result off = first_difference({sizeof(frm_replay_tolerance), 0, 0, 0});
    CHECK(off.tick == 40);
    CHECK(off.time > 0.0799);
    CHECK(off.part == FRM_PART_BUOYANCY);
    CHECK(off.component == 2);
    CHECK(off.replayed == before);
    CHECK(off.recorded == before + 0.01f);
    CHECK(first_difference({sizeof(frm_replay_tolerance), 0, 0.02f, 0}).diverged == 0);
    CHECK(first_difference({sizeof(frm_replay_tolerance), 0, 0.005f, 0}).tick == 40);
    CHECK(first_difference({sizeof(frm_replay_tolerance), 0.01f, 0, 0}).diverged == 0);
    CHECK(first_difference({sizeof(frm_replay_tolerance), 1e-7f, 0, 0}).tick == 40);
}

TEST_CASE("a reader that seeks sees what one that reads through sees, with and without the index", "[recorder]") {
    const Folder folder;
    const std::string path = folder.file("long.frmrec"), cut = folder.file("cut.frmrec");
    {
        Scene scene(path, 1 << 22, true);
        scene.move(0, scene.resting);  // and never again
        for (int t = 1; t <= 3500; ++t) scene.tick(t, 0.01f);
        REQUIRE(frm_recorder_close(scene.recorder) == FRM_OK);
    }
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    std::ofstream(cut, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size() - 10));
    for (const std::string& name : {path, cut}) {
        device::RecordingReader reader(name.c_str());
        CHECK(reader.seek(2500) == (name == path));
        device::Event e;
        std::uint64_t first = 0;
        std::uint32_t bodies = 0;
        bool resting_is_known = false;
        while (reader.next(e)) {
            bodies += std::holds_alternative<device::event::Body>(e);
            if (const auto* motion = std::get_if<device::event::Motion>(&e))
                resting_is_known |= motion->id == 1 && motion->pose.position.y == 0.5;
            if (const auto* tick = std::get_if<device::event::Tick>(&e)) {
                if (first == 0) first = tick->tick;
                if (tick->tick != 2501) continue;
                CHECK(resting_is_known);
                CHECK(bodies == 2);
                CHECK(tick->forces.size() == 2);
                break;
            }
        }
        CHECK(first > 1);
        CHECK(first <= 2501);
        device::RecordingReader through(name.c_str());
        device::Event same;
        while (through.next(same)) {
            const auto* tick = std::get_if<device::event::Tick>(&same);
            if (!tick || tick->tick != 2501) continue;
            const auto& other = std::get<device::event::Tick>(e);
            CHECK(std::memcmp(tick->forces.data(), other.forces.data(), sizeof(Forces) * 2) == 0);
            CHECK(tick->time == other.time);
            break;
        }
    }
}

TEST_CASE("two threads may put into one recording", "[recorder]") {
    // A servo exchanges while the host ticks: what each did is there, in its own order.
    const Folder folder;
    const std::string path = folder.file("two.frmrec");
    Scene scene(path, 1 << 22, true);
    Counting counting;
    frm_device device = 0;
    REQUIRE(frm_device_open(scene.lib.context, &driver, &counting, 0, &device) == FRM_OK);
    REQUIRE(frm_recorder_add_device(scene.recorder, device) == FRM_OK);
    bool good = true;
    std::thread servo([&] {
        for (int i = 0; i < 2000; ++i) {
            frm_device_state state{};
            state.struct_size = sizeof state;
            good &= frm_device_exchange(device, nullptr, &state) == FRM_OK;
        }
    });
    for (int t = 1; t <= 2000; ++t) scene.tick(t);
    servo.join();
    CHECK(good);
    REQUIRE(frm_device_close(device) == FRM_OK);
    REQUIRE(frm_recorder_close(scene.recorder) == FRM_OK);
    CHECK(replay_same(path).ticks == 2000);
    device::RecordingReader reader(path.c_str());
    device::Event e;
    int exchanges = 0;
    while (reader.next(e))
        if (const auto* x = std::get_if<device::event::Exchange>(&e))
            CHECK(x->state.pose.position.x == std::cos(0.01 * ++exchanges));
    CHECK(exchanges == 2000);
}
