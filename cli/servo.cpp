// frm servo: a scene's body in a device's hand, at the servo's rate.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <thread>
#include <utility>

#include "cli/arguments.h"
#include "cli/command.h"
#include "cli/device_sources.h"
#include "cli/file.h"
#include "cli/frm_object.h"
#include "cli/progress.h"
#include "cli/scene.h"

namespace frm::cli {
namespace {

struct Options {
    std::string scene, device, record;
    std::vector<std::string> maps;
    std::uint32_t index = 0, force_interval = 16;
    long rate = 1000, priority = 80;
    double seconds = 0, force_scale = 1, torque_scale = -1, deadline = 0.05;
    Numbers anchor{};
    bool calibrate = false, engage = false, no_lock = false, json = false;
};

/// The scene's one body that a device moves; the others stay where they are.
const SceneBody& held_body(const Scene& scene) {
    const SceneBody* held = nullptr;
    for (const SceneBody& body : scene.bodies) {
        if (body.motion.device().empty()) continue;
        if (held) throw Failure(body.where + ".motion: a servo has one device; " + held->where + " has it");
        held = &body;
    }
    if (!held) throw Failure(scene.path + ": no body has a motion of type \"device\"");
    return *held;
}

/// The library's objects of one run.
class ServoRun {
public:
    ServoRun(const Scene& scene, const Options& o) : record_(o.record) {
        const frm_context context = session_.context();
        const SceneBody& held = held_body(scene);
        frm_world world = 0;
        session_.check(frm_world_create(context, &scene.world, &world), scene.path + ".world");
        if (scene.water) {
            frm_water water = 0;
            session_.check(frm_water_create(world, &*scene.water, &water), scene.path + ".water");
        }
        frm_servo_def def;
        frm_servo_def_init(&def, sizeof def);
        std::map<std::string, frm_map> maps;
        for (const SceneBody& body : scene.bodies) {
            if (!maps.count(body.map)) maps[body.map] = session_.open_map(scene.maps.at(body.map));
            frm_body_def body_def = body.def;
            body_def.map = maps.at(body.map);
            frm_body made = 0;
            session_.check(frm_body_create(world, &body_def, &made), body.where);
            if (&body == &held) def.body = made;
        }
        const std::string name = device_name(held, o);
        def.device = open_device(session_, name, o.index);
        frm_device_safety_def safety;
        session_.check(frm_device_safety_def_init(&safety, sizeof safety));
        safety.deadline_ns = static_cast<std::uint64_t>(std::llround(1e9 * o.deadline));
        session_.check(frm_device_set_safety(def.device, &safety), "--deadline");
        if (o.calibrate) session_.check(frm_device_calibrate(def.device), name);
        require_same_period(name, def.device, o.rate);
        if (!o.record.empty()) {
            require_distinct({o.record}, {scene.path});
            for (const auto& map : scene.maps) require_distinct({o.record}, {map.second});
            require_other_file(o.record, name);
            require_writable(o.record);
            frm_recorder_def recorder_def;
            session_.check(frm_recorder_def_init(&recorder_def, sizeof recorder_def));
            recorder_def.force_interval = o.force_interval;
            session_.check(frm_recorder_create(world, o.record.c_str(), &recorder_def, &recorder_));
            session_.check(frm_recorder_add_device(recorder_, def.device));
        }
        def.rate = static_cast<std::uint32_t>(o.rate);
        def.priority = static_cast<std::uint32_t>(o.priority);
        def.lock_memory = !o.no_lock;
        session_.check(frm_servo_create(context, &def, &servo_));
        frm_servo_input input;
        frm_servo_input_init(&input, sizeof input);
        input.force_scale = static_cast<float>(o.force_scale);
        input.torque_scale = static_cast<float>(o.torque_scale >= 0 ? o.torque_scale : o.force_scale);
        input.anchor.position = {o.anchor[0], o.anchor[1], o.anchor[2]};
        session_.check(frm_servo_set_input(servo_, &input), "--force-scale");
        if (o.engage) session_.check(frm_servo_engage(servo_));
    }

    ~ServoRun() {
        // A recording that is not finished leaves nothing.
        if (recorder_) std::remove((record_ + ".part").c_str());
    }
    ServoRun(const ServoRun&) = delete;
    ServoRun& operator=(const ServoRun&) = delete;

    void start() { session_.check(frm_servo_start(servo_)); }
    void stop() { session_.check(frm_servo_stop(servo_)); }
    void close_recording() {
        if (recorder_) session_.check(frm_recorder_close(std::exchange(recorder_, 0)));
    }

    frm_servo_state state() const {
        frm_servo_state state{};
        state.struct_size = sizeof state;
        session_.check(frm_servo_get_state(servo_, &state));
        return state;
    }
    frm_servo_stats stats() const {
        frm_servo_stats stats{};
        stats.struct_size = sizeof stats;
        session_.check(frm_servo_get_stats(servo_, &stats));
        return stats;
    }
    nlohmann::ordered_json histogram(std::uint32_t which) const {
        std::uint32_t count = 0;
        session_.check(frm_servo_get_histogram(servo_, which, nullptr, nullptr, 0, &count));
        std::vector<std::uint64_t> edges(count), counts(count);
        session_.check(frm_servo_get_histogram(servo_, which, edges.data(), counts.data(), count, &count));
        return {{"edges_ns", edges}, {"counts", counts}};
    }

private:
    /// A name as `frm device list` has it; a scene may name a recording alone.
    static std::string device_name(const SceneBody& held, const Options& o) {
        const std::string& name = o.device.empty() ? held.motion.device() : o.device;
        return !o.device.empty() || is_device_name(name) ? name : "replay:" + name;
    }
    /// A simulated device moves on by its own period in every tick, however long that is.
    void require_same_period(const std::string& name, frm_device device, long rate) const {
        if (name.substr(0, name.find(':')) != "sim") return;
        frm_device_info info{};
        info.struct_size = sizeof info;
        session_.check(frm_device_get_info(device, &info));
        const double period = 1e-9 * static_cast<double>(info.period_ns);
        if (std::fabs(period * static_cast<double>(rate) - 1) > 1e-6)
            throw Failure("--rate " + std::to_string(rate) + ": " + name + " lives " + std::to_string(1e3 * period) +
                          " ms in each tick: set \"period\" of its configuration to 1 / rate");
    }

    Session session_;
    frm_servo servo_ = 0;
    frm_recorder recorder_ = 0;
    std::string record_;
};

nlohmann::ordered_json summary(const Scene& scene, const ServoRun& run) {
    const frm_servo_stats s = run.stats();
    const frm_servo_state state = run.state();
    nlohmann::ordered_json j;
    j["scene"] = scene.title;
    j["period_ns"] = s.period_ns;
    j["ticks"] = s.ticks;
    j["missed"] = s.missed;
    j["skipped"] = s.skipped;
    j["failed_exchanges"] = s.failed_exchanges;
    j["diverged"] = s.diverged;
    j["realtime"] = s.realtime != 0;
    j["memory_locked"] = s.memory_locked != 0;
    j["tick_ns"] = {{"p50", s.tick_p50}, {"p99", s.tick_p99}, {"p9999", s.tick_p9999}, {"max", s.tick_max}};
    j["late_ns"] = {{"p50", s.late_p50}, {"p99", s.late_p99}, {"p9999", s.late_p9999}, {"max", s.late_max}};
    j["tick_histogram"] = run.histogram(FRM_SERVO_TICK);
    j["late_histogram"] = run.histogram(FRM_SERVO_LATE);
    j["status"] = frm_status_name(state.status);
    j["faults"] = state.faults;
    j["reason"] = state.reason;
    return j;
}

void print(const nlohmann::ordered_json& j) {
    const auto us = [&](const char* what, const char* key) { return 1e-3 * j[what][key].get<double>(); };
    std::printf("%s: %llu ticks of %g ms, %llu late into the next, %llu left out\n",
                j["scene"].get<std::string>().c_str(), j["ticks"].get<unsigned long long>(),
                1e-6 * j["period_ns"].get<double>(), j["missed"].get<unsigned long long>(),
                j["skipped"].get<unsigned long long>());
    for (const char* what : {"tick_ns", "late_ns"})
        std::printf("%s: half within %.1f us, 99 %% within %.1f us, 99.99 %% within %.1f us, longest %.1f us\n",
                    what[0] == 't' ? "tick" : "woken late", us(what, "p50"), us(what, "p99"), us(what, "p9999"),
                    us(what, "max"));
    std::printf("real-time priority %s, memory %s\n", j["realtime"].get<bool>() ? "given" : "not given",
                j["memory_locked"].get<bool>() ? "locked" : "not locked");
    const std::string reason = j["reason"];
    if (!reason.empty()) std::printf("%s\n", reason.c_str());
}

void run(const Options& o) {
    Scene scene = read_scene(o.scene, o.maps);
    const double seconds = o.seconds > 0 ? o.seconds : scene.seconds;
    ServoRun run(scene, o);
    run.start();
    const auto begin = std::chrono::steady_clock::now();
    ProgressBar bar("servo");
    for (;;) {
        const double now = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        if (now >= seconds || !run.state().running) break;
        if (!bar.update(now / seconds, std::to_string(run.stats().ticks) + " ticks")) break;
        std::this_thread::sleep_for(std::chrono::duration<double>(std::min(0.05, seconds - now)));
    }
    run.stop();
    run.close_recording();
    const nlohmann::ordered_json result = summary(scene, run);
    if (o.json)
        std::printf("%s\n", result.dump(2).c_str());
    else
        print(result);
    std::fflush(stdout);
    const frm_servo_state state = run.state();
    if (state.status != FRM_OK && state.status != FRM_ERROR_END) throw Unsuccessful();
    if (interrupted() || state.faults != 0) throw Unsuccessful();
}

}  // namespace

void add_servo(CLI::App& app) {
    auto options = std::make_shared<Options>();
    Options& o = *options;
    CLI::App* command =
        app.add_subcommand("servo", "Runs a scene in real time: a device moves its body, and feels what that feels.");
    command->footer(
        "The body is the scene's one with a motion of type \"device\"; what --device names takes the place of\n"
        "the device there. It prints how punctual the servo was (docs/servo.md).\n"
        "  frm servo samples/paddle_in_hand.json --map paddle=paddle.frm --device sim --calibrate --engage \\\n"
        "      --anchor 0,0,0.35 --torque-scale 0.003");
    command->add_option("SCENE", o.scene, "a scene file (JSON)")->required()->check(not_empty())->type_name("");
    command->add_option("--map", o.maps, "where a map of the scene is; may be repeated")
        ->expected(1)
        ->take_all()
        ->type_name("NAME=FILE");
    command->add_option("--device", o.device, "a name from frm device list: null, replay:FILE, sim, spidar")
        ->check(not_empty())
        ->type_name("NAME");
    command->add_option("--index", o.index, "which of the driver's devices")->capture_default_str()->type_name("N");
    add_vector(*command, "--anchor", o.anchor, 1e3, "where the grip's origin is in the world, m (default: 0,0,0)");
    command->add_flag("--calibrate", o.calibrate, "the grip is at its reference pose now (SPIDAR-G: needed each time)");
    command->add_option("--record", o.record, "write a recording, with the device's packets")
        ->check(not_empty())
        ->type_name("FILE");
    command
        ->add_option("--force-interval", o.force_interval, "of the recording: ticks between two whose forces are kept")
        ->check(whole_within(1, 1000000))
        ->capture_default_str()
        ->type_name("N");
    command->add_option("--rate", o.rate, "ticks a second, 100 to 5000; default 1000")
        ->check(whole_within(100, 5000))
        ->type_name("HZ");
    command->add_option("--seconds", o.seconds, "run so long instead of as long as the scene says")
        ->check(positive())
        ->type_name("S");
    command->add_flag("--engage", o.engage, "let the device feel forces; without it they stay off");
    command->add_option("--force-scale", o.force_scale, "of what is felt, 0 to 1000; default 1")
        ->check(number_within(0, 1000))
        ->type_name("X");
    command->add_option("--torque-scale", o.torque_scale, "of torques; default: that of --force-scale")
        ->check(number_within(0, 1000))
        ->type_name("X");
    command->add_option("--deadline", o.deadline, "s without an exchange after which an engaged device is stopped")
        ->check(number_within(1e-3, 10))
        ->capture_default_str()
        ->type_name("S");
    command->add_option("--priority", o.priority, "real-time priority, 1 to 99; 0: none; default 80")
        ->check(whole_within(0, 99))
        ->type_name("N");
    command->add_flag("--no-lock", o.no_lock, "do not lock the program's memory");
    command->add_flag("--json", o.json, "JSON on standard output, with histograms");
    command->callback([options] { run(*options); });
}

}  // namespace frm::cli
