// Results on disk, the folder that processes share, and rounds of tasks.
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

#include "bake/mesh/units.h"
#include "bake/tasks/durable.h"
#include "bake/tasks/locks.h"
#include "bake/tasks/plan_file.h"
#include "bake/tasks/result_file.h"
#include "bake/tasks/rounds.h"
#include "bake/tasks/store.h"
#include "core/error.h"
#include "core/map/codec.h"
#include "core/math/hash.h"
#include "tests/support/catch.h"
#include "tests/support/samples.h"

using namespace frm;
using namespace frm::bake;

namespace {

namespace fs = std::filesystem;

/// An empty folder beside this program, in the build: started by hand in the sources it left its work among them.
std::string fresh_folder(const char* name) {
    const fs::path path = fs::read_symlink("/proc/self/exe").parent_path() / "tasks" / name;
    fs::remove_all(path);
    fs::create_directories(path);
    return path.string();
}

std::set<std::string> names(const std::string& folder) {
    std::set<std::string> found;
    for (const auto& entry : fs::directory_iterator(folder)) found.insert(entry.path().filename().string());
    return found;
}

BakeOptions small_bake() {
    BakeOptions o;
    o.mesh = test::sample_path("box.glb");
    o.quality = Quality::draft;
    o.symmetry = false;  // six flows, then
    o.directions = 6;
    o.sources = 6;
    o.resolution = 4;
    o.threads = 2;
    return o;
}

TaskResult made_up(std::uint32_t regions, float value) {
    TaskResult r;
    r.plan.reference_length = 0.1;
    r.plan.updates = 1e9;
    r.plan.cells = 12345678901;
    r.plan.axes = {Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
    r.plan.blocks.push_back({{-1, -2, -3}, {1, 2, 3}, 0.01, 77});
    r.plan.warning = "thin";
    r.ending = FlowEnding::confidence;
    r.interval = 0.125;
    r.samples = 5;
    r.regions = regions;
    for (std::uint32_t i = 0; i < r.samples * regions * 3; ++i) {
        r.pressure.push_back(value * static_cast<float>(i + 1));
        r.friction.push_back(-value / static_cast<float>(i + 1));
    }
    r.torque.assign(15, value);
    r.uncertainty = {0.01, 0.02, 0.03};
    r.coarse_drag = 3;
    FlowSlice slice;
    slice.normal = 1;
    slice.columns = 2;
    slice.rows = 1;
    slice.speed = {1, std::nanf("")};
    slice.pressure = {0, 0.5f};
    r.slices.push_back(slice);
    r.seconds = 1.5;
    r.mlups = 100;
    return r;
}

bool same(const TaskResult& a, const TaskResult& b) { return encode_result(a, 1) == encode_result(b, 1); }

std::string refusal(const std::vector<std::uint8_t>& file, std::uint64_t key, std::uint32_t regions) {
    try {
        decode_result(file.data(), file.size(), key, regions);
    } catch (const Error& error) {
        return error.text();
    }
    return "";
}

}  // namespace

TEST_CASE("a result comes back from its file as it was", "[tasks]") {
    const TaskResult result = made_up(4, 0.7f);
    const std::vector<std::uint8_t> file = encode_result(result, 99);
    const TaskResult back = decode_result(file.data(), file.size(), 99, 4);
    CHECK(same(result, back));
    CHECK(back.pressure == result.pressure);
    CHECK(back.friction == result.friction);
    CHECK(back.torque == result.torque);
    CHECK(back.ending == FlowEnding::confidence);
    CHECK(back.interval == result.interval);
    CHECK(back.plan.warning == "thin");
    CHECK(back.plan.cells == result.plan.cells);
    CHECK(back.plan.blocks.at(0).high.z == 3);
    CHECK(back.uncertainty.total() == result.uncertainty.total());
    REQUIRE(back.slices.size() == 1);
    CHECK(std::isnan(back.slices[0].speed.at(1)));
    CHECK(back.slices[0].pressure == result.slices[0].pressure);
    CHECK(back.seconds == 1.5);
}

TEST_CASE("no changed, missing or added byte passes for a result", "[tasks]") {
    const std::vector<std::uint8_t> file = encode_result(made_up(4, 0.7f), 99);
    CHECK(refusal(file, 98, 4).find("another mesh") != std::string::npos);
    CHECK(refusal(file, 99, 5).find("another mesh") != std::string::npos);
    for (std::size_t i = 0; i < file.size(); ++i) {
        std::vector<std::uint8_t> changed = file;
        changed[i] ^= static_cast<std::uint8_t>(1 + i % 255);
        CHECK(!refusal(changed, 99, 4).empty());
        changed.assign(file.begin(), file.begin() + static_cast<std::ptrdiff_t>(i));
        CHECK(!refusal(changed, 99, 4).empty());
    }
    std::vector<std::uint8_t> longer = file;
    longer.push_back(0);
    CHECK(!refusal(longer, 99, 4).empty());
}

TEST_CASE("a file that was made to look right asks for no more memory than it may", "[tasks]") {
    std::vector<std::uint8_t> file = encode_result(made_up(4, 0.7f), 99);
    const auto put = [&](std::size_t at, std::uint64_t v, int bytes) {
        for (int i = 0; i < bytes; ++i)
            file[at + static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(v >> (8 * i));
    };
    SECTION("samples") { put(12, 0xFFFFFFFF, 4); }
    SECTION("contents") { put(32, std::uint64_t{1} << 60, 8); }
    SECTION("both") {
        put(12, 0x0FFFFFFF, 4);
        put(32, std::uint64_t{0x0FFFFFFF} * 4 * 24, 8);
    }
    CHECK(refusal(file, 99, 4).find("size does not match") != std::string::npos);
}

TEST_CASE("a force that is not a number, or a run that was cut short, is no result", "[tasks]") {
    TaskResult result = made_up(4, 0.7f);
    result.friction[7] = std::nanf("");
    CHECK(refusal(encode_result(result, 1), 1, 4).find("not a finite number") != std::string::npos);
    result = made_up(4, 0.7f);
    result.ending = FlowEnding::cancelled;
    CHECK(refusal(encode_result(result, 1), 1, 4).find("not finished") != std::string::npos);
}

TEST_CASE("a result is good for one case alone", "[tasks]") {
    const BakePlan plan = plan_bake(small_bake());
    const std::uint64_t body = hash_of_body(plan.surface, plan.patches);
    std::set<std::uint64_t> keys;
    for (const Task& task : plan.tasks) keys.insert(key_of(body, task.flow));
    CHECK(keys.size() == plan.tasks.size());
    FlowCase c = plan.tasks[0].flow;
    c.threads = 7;
    c.memory_limit = 1;
    CHECK(keys.count(key_of(body, c)) == 1);
    c.start_up += 1;
    CHECK(keys.count(key_of(body, c)) == 0);
    Surface other = plan.surface;
    other.vertices[0].x += 1e-9;
    CHECK(hash_of_body(other, plan.patches) != body);
    Regions patches = plan.patches;
    patches.region[0] = (patches.region[0] + 1) % patches.count;
    CHECK(hash_of_body(plan.surface, patches) != body);
}

TEST_CASE("a plan's file gives the options back, and nothing that leads elsewhere", "[tasks]") {
    BakeOptions options = small_bake();
    options.scale = 0.0254;
    options.viscosity = 1.1e-6;
    const BakePlan plan = plan_bake(options);
    const std::string fingerprint = fingerprint_of(plan), text = plan_text(plan, fingerprint, 8);
    const PlanFile back = parse_plan(text, "plan.json");
    CHECK(back.fingerprint == fingerprint);
    CHECK(back.tasks == 8);
    CHECK(back.options.mesh == "box.glb");
    CHECK(back.options.scale == options.scale);
    CHECK(back.options.viscosity == options.viscosity);
    CHECK(back.options.directions == 6);
    CHECK(back.options.quality == Quality::draft);
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string other = text;
        const std::size_t at = other.find(from);
        REQUIRE(at != std::string::npos);
        return other.replace(at, from.size(), to);
    };
    CHECK_THROWS_AS(parse_plan(changed("box.glb", "../box.glb"), "p"), BakeError);
    CHECK_THROWS_AS(parse_plan(changed("\"draft\"", "\"quick\""), "p"), BakeError);
    CHECK_THROWS_AS(parse_plan(changed("\"sources\": 6", "\"sources\": -6"), "p"), BakeError);
    CHECK_THROWS_AS(parse_plan(changed("\"sources\"", "\"wells\""), "p"), BakeError);
    CHECK_THROWS_AS(parse_plan(changed("frm flow", "other"), "p"), BakeError);
    CHECK_THROWS_AS(parse_plan(text.substr(0, text.size() / 2), "p"), BakeError);
    CHECK_THROWS_AS(parse_plan("[1, 2]", "p"), BakeError);
}

TEST_CASE("every option but threads and the mesh's folder makes another fingerprint", "[tasks]") {
    const std::string folder = fresh_folder("fingerprint");
    const BakeOptions first = small_bake();
    std::set<std::string> prints{fingerprint_of(plan_bake(first))};
    const auto with = [&](const std::function<void(BakeOptions&)>& change) {
        BakeOptions o = first;
        change(o);
        return fingerprint_of(plan_bake(o));
    };
    CHECK(prints.count(with([](BakeOptions& o) { o.threads = 1; })) == 1);
    fs::copy_file(first.mesh, folder + "/box.glb");
    CHECK(prints.count(with([&](BakeOptions& o) { o.mesh = folder + "/box.glb"; })) == 1);
    fs::copy_file(first.mesh, folder + "/other.glb");
    for (const std::function<void(BakeOptions&)>& change : std::vector<std::function<void(BakeOptions&)>>{
             [](BakeOptions& o) { o.scale = 2; }, [](BakeOptions& o) { o.quality = Quality::standard; },
             [](BakeOptions& o) { o.speed = 1; }, [](BakeOptions& o) { o.density = 999; },
             [](BakeOptions& o) { o.viscosity = 2e-6; }, [](BakeOptions& o) { o.directions = 18; },
             [](BakeOptions& o) { o.sources = 7; }, [](BakeOptions& o) { o.resolution = 5; },
             [](BakeOptions& o) { o.triangles = 500; }, [](BakeOptions& o) { o.speeds = {1}; },
             [](BakeOptions& o) { o.spin = true; }, [](BakeOptions& o) { o.added_mass = false; },
             [](BakeOptions& o) { o.symmetry = true; }, [](BakeOptions& o) { o.threshold = 0.01; },
             [&](BakeOptions& o) { o.mesh = folder + "/other.glb"; }})
        CHECK(prints.insert(with(change)).second);
}

TEST_CASE("two users of a folder share its tasks, and the last one takes it away", "[tasks]") {
    const BakePlan plan = plan_bake(small_bake());
    const std::string folder = fresh_folder("shared") + "/work";
    Store a(folder, plan), b(folder, plan);
    const Task& task = plan.tasks[3];
    TaskResult result;
    CHECK(a.claim(3, task, result) == Store::Claim::ours);
    CHECK(b.claim(3, task, result) == Store::Claim::elsewhere);
    CHECK(b.claim(2, plan.tasks[2], result) == Store::Claim::ours);
    CHECK(!b.has(3));
    a.save(3, task, made_up(plan.patches.count, 2));
    CHECK(b.has(3));
    CHECK(b.claim(3, task, result) == Store::Claim::done);
    CHECK(same(result, made_up(plan.patches.count, 2)));
    b.give_back(2);
    CHECK(a.claim(2, plan.tasks[2], result) == Store::Claim::ours);
    CHECK(a.count(plan.tasks.size()) == 1);

    CHECK(!a.remove());
    CHECK(b.has(3));
    { const Store gone(std::move(folder), plan); }
    // A task's lock does not outlive its holder.
    {
        Store c(a.folder(), plan);
        CHECK(c.claim(5, plan.tasks[5], result) == Store::Claim::ours);
        CHECK(b.claim(5, plan.tasks[5], result) == Store::Claim::elsewhere);
    }
    CHECK(b.claim(5, plan.tasks[5], result) == Store::Claim::ours);
}

TEST_CASE("the folder goes with the last user, but not what somebody else put there", "[tasks]") {
    const BakePlan plan = plan_bake(small_bake());
    const std::string folder = fresh_folder("last") + "/work";
    {
        Store store(folder, plan);
        store.save(1, plan.tasks[1], made_up(plan.patches.count, 1));
        std::ofstream(folder + "/mine.txt") << "mine";
        CHECK(!store.remove());
    }
    CHECK(names(folder) == std::set<std::string>{"mine.txt"});
    fs::remove(folder + "/mine.txt");
    Store store(folder, plan);
    CHECK(!store.has(1));
    CHECK(store.remove());
    CHECK(!fs::exists(folder));
}

TEST_CASE("the lock of a process that was killed is free", "[tasks]") {
    const std::string path = fresh_folder("killed") + "/locks";
    int ready[2];
    REQUIRE(pipe(ready) == 0);
    const pid_t child = fork();
    if (child == 0) {
        LockFile locks(path);
        const char said = locks.try_lock(4) ? 'y' : 'n';
        if (write(ready[1], &said, 1) != 1) _exit(1);
        for (;;) pause();
    }
    char said = 0;
    REQUIRE(read(ready[0], &said, 1) == 1);
    CHECK(said == 'y');
    LockFile locks(path);
    REQUIRE(locks.work());
    CHECK(!locks.try_lock(4));
    CHECK(locks.try_lock(5));
    CHECK(!locks.exclusive());
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    CHECK(locks.try_lock(4));
    CHECK(locks.exclusive());
    close(ready[0]), close(ready[1]);
}

TEST_CASE("who comes while a folder is taken away makes a new one", "[tasks]") {
    const BakePlan plan = plan_bake(small_bake());
    const std::string folder = fresh_folder("race") + "/work";
    std::atomic<bool> stop{false};
    std::atomic<int> bad{0};
    const auto come_and_go = [&] {
        TaskResult result;
        while (!stop) {
            Store store(folder, plan);
            if (store.claim(0, plan.tasks[0], result) == Store::Claim::ours)
                store.save(0, plan.tasks[0], made_up(plan.patches.count, 1));
            // While we are its user nobody may take the file away.
            if (store.has(0) && !store.load(0, plan.tasks[0], result)) ++bad;
            store.remove();
        }
    };
    std::thread one(come_and_go), two(come_and_go);
    std::this_thread::sleep_for(std::chrono::milliseconds(1500));
    stop = true;
    one.join();
    two.join();
    CHECK(bad == 0);
}

TEST_CASE("damaged, foreign and half-written files are solved again", "[tasks]") {
    const BakePlan plan = plan_bake(small_bake());
    const std::string folder = fresh_folder("damaged");
    std::vector<std::string> notes;
    Store store(folder, plan, [&](const std::string& text) { notes.push_back(text); });
    for (std::size_t k = 0; k < 4; ++k) store.save(k, plan.tasks[k], made_up(plan.patches.count, 1));
    fs::resize_file(folder + "/task-00000.flow", 100);
    fs::copy_file(folder + "/task-00002.flow", folder + "/task-00001.flow", fs::copy_options::overwrite_existing);
    fs::remove(folder + "/task-00003.flow");
    fs::create_directory(folder + "/task-00003.flow");
    std::ofstream(folder + "/task-00000.flow.tmp.1-2-3") << "torn";
    TaskResult result;
    CHECK(store.claim(0, plan.tasks[0], result) == Store::Claim::ours);
    CHECK(store.claim(1, plan.tasks[1], result) == Store::Claim::ours);
    CHECK(store.claim(2, plan.tasks[2], result) == Store::Claim::done);
    CHECK(store.claim(3, plan.tasks[3], result) == Store::Claim::ours);
    CHECK(names(folder) == std::set<std::string>{"locks", "plan.json", "task-00002.flow"});
    const std::string all = [&] {
        std::string text;
        for (const std::string& note : notes) text += note + "\n";
        return text;
    }();
    CHECK(all.find("task-00000.flow: the flow's file: it is damaged") != std::string::npos);
    CHECK(all.find("task-00001.flow: the flow's file: it is of another mesh") != std::string::npos);
    CHECK(all.find(plan.tasks[3].name + " is solved again") != std::string::npos);
}

TEST_CASE("a folder of another bake is refused, a damaged plan is written again", "[tasks]") {
    const BakePlan plan = plan_bake(small_bake());
    BakeOptions options = small_bake();
    options.speed = 1;
    const std::string folder = fresh_folder("other");
    { const Store store(folder, plan); }
    CHECK_THROWS_AS(Store(folder, plan_bake(options)), FileError);
    std::ofstream(folder + "/plan.json") << "{";
    int notes = 0;
    {
        const Store store(folder, plan, [&](const std::string&) { ++notes; });
    }
    CHECK(notes == 1);
    {
        const Store store(folder, plan, [&](const std::string&) { ++notes; });
    }
    CHECK(notes == 1);
}

TEST_CASE("a file that does not fit leaves nothing, and the older one", "[tasks]") {
    const std::string folder = fresh_folder("full"), path = folder + "/file";
    write_durably(path, "older", 5);
    const std::vector<char> large(1 << 20, 'x');
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    void (*const old)(int) = std::signal(SIGXFSZ, SIG_IGN);
    rlimit small = before;
    small.rlim_cur = 100000;
    setrlimit(RLIMIT_FSIZE, &small);
    std::string text;
    try {
        write_durably(path, large.data(), large.size());
    } catch (const FileError& error) {
        text = error.what();
    }
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, old);
    CHECK(text == path + ": File too large");
    CHECK(names(folder) == std::set<std::string>{"file"});
    std::vector<std::uint8_t> bytes;
    CHECK(read_whole(path, 100, bytes));
    CHECK(std::string(bytes.begin(), bytes.end()) == "older");
    CHECK_THROWS_AS(read_whole(path, 4, bytes), FileError);
    CHECK_THROWS_AS(write_durably(folder + "/nowhere/file", "x", 1), FileError);
}

TEST_CASE("rounds: results ask for more tasks, in memory, from a folder, and cut anywhere", "[tasks]") {
    // A stand-in for a plan that asks twice: for one flow that is a little faster, then for another.
    const ExtendPlan extend = [](BakePlan& plan, const std::vector<TaskResult>& results) {
        REQUIRE(results.size() == plan.tasks.size());
        for (const TaskResult& result : results) REQUIRE(result.samples > 0);
        if (plan.tasks.size() >= 4) return false;
        Task task = plan.tasks[0];
        task.name = "more " + std::to_string(plan.tasks.size());
        // The next task follows from what the last one found.
        task.flow.speed *= 1 + 0.01 * std::fabs(static_cast<double>(results.back().pressure[0]));
        plan.tasks.push_back(task);
        return true;
    };
    const auto first = [] {
        BakePlan plan = plan_bake(small_bake());
        plan.tasks.resize(2);
        return plan;
    };
    BakePlan plan = first();
    RunSettings settings;
    const std::vector<TaskResult> expected = solve_rounds(plan, settings, nullptr, extend);
    REQUIRE(expected.size() == 4);
    const auto check = [&](const std::vector<TaskResult>& results) {
        REQUIRE(results.size() == 4);
        for (std::size_t k = 0; k < 4; ++k) {
            CHECK(results[k].pressure == expected[k].pressure);
            CHECK(results[k].friction == expected[k].friction);
        }
    };

    // Cancelled at the first word, again and again: each time there is one more that stays.
    const std::string folder = fresh_folder("rounds");
    std::size_t runs = 0;
    for (;; ++runs) {
        BakePlan again = first();
        Store store(folder, again);
        settings.store = &store;
        settings.threads = 1;
        const std::size_t kept = store.count(4);
        try {
            check(solve_rounds(
                again, settings, [&](const RunState&) { return store.count(4) <= kept; }, extend));
            break;
        } catch (const FlowCancelled&) {
            CHECK(store.count(4) > kept);
        }
        REQUIRE(runs < 5);
    }
    CHECK(runs >= 1);

    // Piece by piece, as jobs do: what is found grows round by round; a lost task comes back.
    const std::string jobs = fresh_folder("jobs");
    std::size_t known = 2;
    std::vector<std::size_t> asked;
    for (int step = 0;; ++step) {
        REQUIRE(step < 10);
        BakePlan again = first();
        Store store(jobs, again);
        const Found found = find_rounds(again, store, known, extend);
        if (found.missing.empty()) {
            check(found.results);
            break;
        }
        CHECK(found.extended == (again.tasks.size() > known));
        known = again.tasks.size();
        asked.push_back(found.missing.back());
        RunSettings one;
        one.store = &store;
        run_tasks(again.surface, again.patches, again.tasks, {found.missing.back()}, one, nullptr,
                  [](std::size_t, TaskResult&&, bool solved) { CHECK(solved); });
        if (step == 2) fs::remove(jobs + "/task-00001.flow");
    }
    CHECK(asked == std::vector<std::size_t>{1, 0, 2, 1, 3});
}

TEST_CASE("the unit that a mesh was drawn in", "[units]") {
    CHECK(plausible_size(1.5));
    CHECK(plausible_size(0.01));
    CHECK(plausible_size(12));
    CHECK(!plausible_size(30));
    CHECK(!plausible_size(0.0015));
    CHECK(likely_units(1500).front().scale == 0.001);  // a paddle in millimetres
    CHECK(likely_units(150).front().scale == 0.01);    // in centimetres
    CHECK(likely_units(59).front().scale == 0.01);
    CHECK(likely_units(39).front().scale == 0.0254);    // in inches: a metre
    CHECK(likely_units(0.0015).front().scale == 1000);  // converted twice
    const std::vector<Unit> units = likely_units(30);   // 0.76 m, 0.3 m and 3 cm
    REQUIRE(units.size() == 3);
    CHECK(units[1].scale == 0.01);
    CHECK(units[2].scale == 0.001);
    CHECK(likely_units(1500).size() == 2);  // 38 m were not plausible
}
