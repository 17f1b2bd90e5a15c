#include <cmath>
#include <fstream>
#include <iterator>

#include "device/recording.h"
#include "tests/support/library.h"

using namespace frm;
using test::Folder;
using test::Library;

namespace {

/// A scene of everything: water, two bodies, one taken out and one put in on the way, pressure set, a device.
void record(const std::string& path, int ticks = 150) {
    const Library lib;
    frm_world world = 0;
    REQUIRE(frm_world_create(lib.context, nullptr, &world) == FRM_OK);
    frm_recorder recorder = 0;
    frm_recorder_def recorder_def;
    frm_recorder_def_init(&recorder_def, sizeof recorder_def);
    recorder_def.hash_interval = 10;
    REQUIRE(frm_recorder_create(world, path.c_str(), &recorder_def, &recorder) == FRM_OK);
    frm_device device = 0;
    REQUIRE(frm_device_open_null(lib.context, &device) == FRM_OK);
    REQUIRE(frm_recorder_add_device(recorder, device) == FRM_OK);
    frm_water_def water_def;
    frm_water_def_init(&water_def, sizeof water_def);
    water_def.nx = water_def.ny = 64;
    frm_water water = 0;
    REQUIRE(frm_water_create(world, &water_def, &water) == FRM_OK);
    std::vector<float> field(64 * 64, 0.0f);
    field[2000] = 0.01f;
    REQUIRE(frm_water_set_height(water, field.data(), field.size()) == FRM_OK);
    frm_body_def def;
    frm_body_def_init(&def, sizeof def);
    def.map = lib.map();
    def.mass = 1;
    frm_body one = 0, two = 0, three = 0;
    REQUIRE(frm_body_create(world, &def, &one) == FRM_OK);
    def.scale = 0.5f;
    def.pose.position.x = 0.4;
    REQUIRE(frm_body_create(world, &def, &two) == FRM_OK);
    for (int t = 0; t < ticks; ++t) {
        frm_device_state state{};
        state.struct_size = sizeof state;
        REQUIRE(frm_device_exchange(device, nullptr, &state) == FRM_OK);
        const double phase = 0.05 * t;
        const frm_pose pose{{0.2 * std::sin(phase), 0, 0.1 * std::cos(phase)}, {0.1f, 0, 0.2f, 1}};
        const frm_twist twist{{0.5f, 0.1f, -0.2f}, {0, 1, 0}};
        REQUIRE(frm_body_set_motion(one, &pose, &twist) == FRM_OK);
        if (t == 60) REQUIRE(frm_body_destroy(two) == FRM_OK);
        if (t == 80) REQUIRE(frm_water_set_pressure(water, field.data(), field.size()) == FRM_OK);
        if (t == 90) REQUIRE(frm_body_create(world, &def, &three) == FRM_OK);
        if (t == 100) REQUIRE(frm_water_set_pressure(water, nullptr, 0) == FRM_OK);
        REQUIRE(frm_world_tick(world, t % 3 ? 0.002f : 0.003f) == FRM_OK);
    }
    REQUIRE(frm_recorder_close(recorder) == FRM_OK);
}

struct Outcome {
    std::uint64_t ticks = 0;
    frm_replay_step_result first{};  ///< difference
    bool torn = false;
    frm_status opened = FRM_OK;
};

Outcome replay(const std::string& path, std::uint32_t threads = 1) {
    frm_context_def context_def;
    frm_context_def_init(&context_def, sizeof context_def);
    context_def.threads = threads;
    frm_context context = 0;
    REQUIRE(frm_context_create(&context_def, &context) == FRM_OK);
    Outcome out;
    frm_replay r = 0;
    out.opened = frm_replay_open(context, path.c_str(), &r);
    if (out.opened == FRM_OK) {
        frm_replay_info info{};
        info.struct_size = sizeof info;
        REQUIRE(frm_replay_get_info(r, &info) == FRM_OK);
        out.torn = info.torn != 0;
        frm_replay_step_result result{};
        result.struct_size = sizeof result;
        frm_status status = FRM_OK;
        while ((status = frm_replay_step(r, &result)) == FRM_OK) {
            ++out.ticks;
            if (result.diverged && !out.first.diverged) out.first = result;
        }
        REQUIRE(status == FRM_ERROR_END);
        CHECK(info.ticks == out.ticks);
    }
    frm_context_destroy(context);
    return out;
}

std::vector<char> read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

void write(const std::string& path, const std::vector<char>& bytes) {
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// Rewrites a recording with its events changed.
template <typename Change>
void rewrite(const std::string& from, const std::string& to, Change&& change) {
    device::RecordingReader reader(from.c_str());
    device::RecordingWriter writer(to.c_str());
    device::Event e;
    while (reader.next(e)) {
        change(e);
        writer.write(e);
    }
    writer.close();
}

}  // namespace

TEST_CASE("a recording replays to the same bits, with any number of threads", "[recording]") {
    const Folder folder;
    const std::string path = folder.file("all.frmrec");
    record(path);
    CHECK_FALSE(std::filesystem::exists(path + ".part"));
    for (const std::uint32_t threads : {1u, 2u}) {
        const Outcome outcome = replay(path, threads);
        CHECK(outcome.opened == FRM_OK);
        CHECK(outcome.ticks == 150);
        CHECK(outcome.first.diverged == 0);
        CHECK_FALSE(outcome.torn);
    }
    const std::string again = folder.file("again.frmrec");
    record(again);
    CHECK(read(path) == read(again));
}

TEST_CASE("the first difference is named: tick, body and part", "[recording]") {
    const Folder folder;
    const std::string path = folder.file("good.frmrec"), bad = folder.file("bad.frmrec");
    record(path);
    std::uint64_t tick = 0;
    rewrite(path, bad, [&](device::Event& e) {
        auto* t = std::get_if<device::event::Tick>(&e);
        if (!t) return;
        if (++tick == 37) t->forces[1].friction.torque.y = std::nextafter(t->forces[1].friction.torque.y, 1e9f);
        if (tick == 50) t->forces[0].buoyancy.force.x += 1;
    });
    const Outcome outcome = replay(bad);
    CHECK(outcome.first.diverged == 1);
    CHECK(outcome.first.tick == 37);
    CHECK(outcome.first.body == 1);
    CHECK(outcome.first.part == FRM_PART_FRICTION);
    CHECK(outcome.ticks == 150);

    // A changed input shows in what follows from it; a changed hash in the world.
    tick = 0;
    rewrite(path, bad, [&](device::Event& e) {
        if (std::holds_alternative<device::event::Tick>(e)) ++tick;
        auto* m = std::get_if<device::event::Motion>(&e);
        if (m && tick == 20) m->twist.linear.x = 0.500001f;
    });
    const Outcome moved = replay(bad);
    CHECK(moved.first.tick == 21);
    CHECK(moved.first.part == FRM_PART_PRESSURE);
    tick = 0;
    rewrite(path, bad, [&](device::Event& e) {
        auto* t = std::get_if<device::event::Tick>(&e);
        if (t && ++tick == 30) t->hash ^= 1;
    });
    const Outcome hashed = replay(bad);
    CHECK(hashed.first.tick == 30);
    CHECK(hashed.first.part == FRM_PART_WORLD);
}

TEST_CASE("a recording that was cut off anywhere keeps what came before", "[recording]") {
    const Folder folder;
    const std::string path = folder.file("whole.frmrec"), cut = folder.file("cut.frmrec");
    record(path);
    const std::vector<char> whole = read(path);
    std::uint64_t before = 0;
    for (std::size_t size = 0; size < whole.size(); size += size < 600 ? 13 : 97) {
        write(cut, {whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
        const Outcome outcome = replay(cut);
        if (outcome.opened != FRM_OK) {
            // Not even the world had been written.
            REQUIRE(outcome.opened == FRM_ERROR_CORRUPT);
            REQUIRE(before == 0);
            continue;
        }
        REQUIRE((outcome.torn || outcome.ticks == 150));  // what follows the last event is the index
        REQUIRE(outcome.first.diverged == 0);
        REQUIRE(outcome.ticks >= before);
        before = outcome.ticks;
    }
    CHECK(before == 150);  // all ticks come before the last bytes
}

TEST_CASE("damage inside a recording is an error, not a crash", "[recording]") {
    const Folder folder;
    const std::string path = folder.file("good.frmrec"), bad = folder.file("bad.frmrec");
    record(path, 70);
    const std::vector<char> good = read(path);
    int refused = 0, tried = 0;
    for (std::size_t i = 0; i < good.size(); i += 29) {
        std::vector<char> other = good;
        other[i] = static_cast<char>(other[i] ^ 0x10);
        write(bad, other);
        const Library lib;
        frm_replay r = 0;
        const frm_status status = frm_replay_open(lib.context, bad.c_str(), &r);
        ++tried;
        REQUIRE((status == FRM_OK || status == FRM_ERROR_CORRUPT || status == FRM_ERROR_VERSION));
        refused += status != FRM_OK;
        if (status != FRM_OK) {
            CHECK(lib.error().find("bad.frmrec") != std::string::npos);
            continue;
        }
        // Only the index, which a replay does without, follows the last event.
        frm_replay_info info{};
        info.struct_size = sizeof info;
        REQUIRE(frm_replay_get_info(r, &info) == FRM_OK);
        REQUIRE(info.ticks == 70);
        REQUIRE(info.torn == 0);
    }
    CHECK(refused > tried * 9 / 10);
}

TEST_CASE("what cannot be recorded is refused in words", "[recording]") {
    const Folder folder;
    const Library lib;
    frm_world world = 0;
    REQUIRE(frm_world_create(lib.context, nullptr, &world) == FRM_OK);
    frm_recorder recorder = 0;
    CHECK(frm_recorder_create(world, (folder.file("none") + "/x/y").c_str(), nullptr, &recorder) == FRM_ERROR_FILE);
    CHECK(lib.error().find("No such file") != std::string::npos);
    REQUIRE(frm_world_tick(world, 0.002f) == FRM_OK);
    CHECK(frm_recorder_create(world, folder.file("late").c_str(), nullptr, &recorder) == FRM_ERROR_STATE);
    CHECK(lib.error().find("ticked already") != std::string::npos);
    CHECK(std::filesystem::is_empty(folder.path));
}

TEST_CASE("a full disk is reported when the recording is closed, and ticks go on", "[recording]") {
    if (!std::filesystem::exists("/dev/full")) return;
    const Folder folder;
    // The .part file is a link to a device that takes nothing.
    const std::string path = folder.file("full.frmrec");
    std::filesystem::create_symlink("/dev/full", path + ".part");
    const Library lib;
    frm_world world = 0;
    REQUIRE(frm_world_create(lib.context, nullptr, &world) == FRM_OK);
    frm_recorder recorder = 0;
    REQUIRE(frm_recorder_create(world, path.c_str(), nullptr, &recorder) == FRM_OK);
    for (int t = 0; t < 200; ++t) REQUIRE(frm_world_tick(world, 0.002f) == FRM_OK);
    CHECK(frm_recorder_close(recorder) == FRM_ERROR_FILE);
    CHECK(lib.error().find("No space left") != std::string::npos);
    CHECK_FALSE(std::filesystem::exists(path));
    CHECK(frm_recorder_close(recorder) == FRM_ERROR_HANDLE);
}

TEST_CASE("a replay's world can be looked at and not changed", "[recording]") {
    const Folder folder;
    const std::string path = folder.file("look.frmrec");
    record(path, 20);
    const Library lib;
    frm_replay r = 0;
    REQUIRE(frm_replay_open(lib.context, path.c_str(), &r) == FRM_OK);
    frm_world world = 0;
    REQUIRE(frm_replay_get_world(r, &world) == FRM_OK);
    CHECK(frm_world_tick(world, 0.002f) == FRM_ERROR_STATE);
    CHECK(frm_world_destroy(world) == FRM_ERROR_STATE);
    frm_body body = 0;
    REQUIRE(frm_replay_get_body(r, 1, &body) == FRM_OK);
    CHECK(frm_body_destroy(body) == FRM_ERROR_STATE);
    frm_map map = 0;
    REQUIRE(frm_replay_get_map(r, 0, &map) == FRM_OK);
    frm_body_def def{};
    def.struct_size = sizeof def;
    REQUIRE(frm_body_get_def(body, &def) == FRM_OK);
    CHECK(def.map == map);
    CHECK(def.scale == 0.5f);
    REQUIRE(frm_replay_close(r) == FRM_OK);
    CHECK(frm_world_tick(world, 0.002f) == FRM_ERROR_HANDLE);
    CHECK(frm_map_close(map) == FRM_ERROR_HANDLE);
}

TEST_CASE("recordings of older versions are read", "[recording]") {
    for (const char* name : {"/v1.frmrec", "/v2.frmrec"}) {
        device::RecordingReader reader((std::string(FRM_TEST_DATA) + name).c_str());
        const bool first = reader.version() == 1;
        device::Event event;
        std::uint64_t ticks = 0;
        double time = 0;
        bool ended = false;
        while (reader.next(event)) {
            // Version 1 had no rules of what to skip, and waves of second order alone.
            if (const auto* world = std::get_if<device::event::World>(&event))
                CHECK((world->def.skip == skip_nothing) == first);
            if (const auto* water = std::get_if<device::event::Water>(&event)) CHECK(water->def.field.order == 2);
            if (const auto* tick = std::get_if<device::event::Tick>(&event)) {
                CHECK(tick->tick == ++ticks);
                CHECK(tick->time > time);
                time = tick->time;
            }
            if (const auto* end = std::get_if<device::event::End>(&event)) ended = end->ticks == ticks;
        }
        CHECK(ended);
        CHECK(ticks == 300);
        CHECK_FALSE(reader.torn());
    }
}
