// frm run: a scene, tick by tick.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <utility>

#include "cli/command.h"
#include "cli/device_sources.h"
#include "cli/file.h"
#include "cli/frm_object.h"
#include "cli/progress.h"
#include "cli/report.h"
#include "cli/scene.h"
#include "cli/tick_times.h"
#include "core/math/hash.h"

namespace frm::cli {
namespace {

struct Options {
    std::string scene, preset, record, report, csv;
    std::vector<std::string> maps;
    double seconds = 0;
    bool json = false;
};

struct RunningBody {
    const SceneBody* scene = nullptr;
    frm_body body = 0;
    frm_device device = 0;
    frm_forces forces{};
    double peak_force = 0, peak_torque = 0, peak_time = 0;
};

double size(const frm_vec3& v) {
    return std::sqrt(static_cast<double>(v.x) * static_cast<double>(v.x) +
                     static_cast<double>(v.y) * static_cast<double>(v.y) +
                     static_cast<double>(v.z) * static_cast<double>(v.z));
}

/// The path in a scene's device: a recording may be named alone, or as frm device list does.
std::string recording_of(const std::string& device) {
    const std::string prefix = "replay:";
    return device.compare(0, prefix.size(), prefix) == 0 ? device.substr(prefix.size()) : device;
}

/// The scene in the library: worlds, bodies, devices, recorder; and one tick after another. A recording that is not
/// closed by close() leaves nothing.
class Run {
public:
    explicit Run(const Scene& scene) : scene_(scene) {
        const frm_context context = session_.context();
        session_.check(frm_world_create(context, &scene.world, &world_), scene.path + ".world");
        if (scene.water) {
            frm_water water = 0;
            session_.check(frm_water_create(world_, &*scene.water, &water), scene.path + ".water");
        }
        std::map<std::string, frm_map> maps;
        for (const SceneBody& body : scene.bodies)
            if (!maps.count(body.map)) maps[body.map] = session_.open_map(scene.maps.at(body.map));
        for (const SceneBody& body : scene.bodies) {
            RunningBody running;
            running.scene = &body;
            running.forces.struct_size = sizeof running.forces;
            frm_body_def def = body.def;
            def.map = maps.at(body.map);
            session_.check(frm_body_create(world_, &def, &running.body), body.where);
            const std::string& device = body.motion.device();
            if (device == "null") {
                session_.check(frm_device_open_null(context, &running.device));
            } else if (!device.empty()) {
                const std::string file = recording_of(device);
                if (file == device && is_device_name(device))
                    throw Failure(body.where + ".motion.device: " + device +
                                  " is a device for real time: play the scene with frm servo");
                session_.check(frm_device_open_replay(context, file.c_str(), 0, &running.device),
                               body.where + ".motion.device");
            }
            bodies_.push_back(running);
        }
    }
    ~Run() {
        // The library closes a recording with its context and gives it its name, for which this must be there.
        if (recorder_) std::remove((recording_ + ".part").c_str());
    }
    Run(const Run&) = delete;
    Run& operator=(const Run&) = delete;

    void record(const std::string& path) {
        frm_recorder_def def;
        session_.check(frm_recorder_def_init(&def, sizeof def));
        def.waits = 1;
        session_.check(frm_recorder_create(world_, path.c_str(), &def, &recorder_));
        recording_ = path;
        for (const RunningBody& body : bodies_)
            if (body.device) session_.check(frm_recorder_add_device(recorder_, body.device));
    }

    void tick(double time) {
        for (RunningBody& body : bodies_) move(body, time);
        const auto begin = std::chrono::steady_clock::now();
        session_.check(frm_world_tick(world_, static_cast<float>(scene_.dt)), at(time));
        const auto end = std::chrono::steady_clock::now();
        times_.add(std::chrono::duration<double, std::micro>(end - begin).count());
        for (RunningBody& body : bodies_) {
            session_.check(frm_body_get_forces(body.body, &body.forces));
            const double force = size(body.forces.total.force);
            if (force > body.peak_force) body.peak_force = force, body.peak_time = time;
            body.peak_torque = std::fmax(body.peak_torque, size(body.forces.total.torque));
        }
    }

    void close() {
        if (recorder_) session_.check(frm_recorder_close(std::exchange(recorder_, 0)));
    }

    std::uint64_t hash() const {
        std::uint64_t hash = 0;
        session_.check(frm_world_hash(world_, &hash));
        return hash;
    }

    std::string csv_rows(double time) const {
        std::string text;
        for (const RunningBody& body : bodies_) {
            char begin[64];
            std::snprintf(begin, sizeof begin, "%.9g,", time);
            text += begin + body.scene->name;
            const frm_forces& f = body.forces;
            for (const frm_wrench* w : {&f.total, &f.buoyancy, &f.pressure, &f.friction, &f.gravity})
                for (const frm_vec3* v : {&w->force, &w->torque}) {
                    char three[80];
                    std::snprintf(three, sizeof three, ",%.9g,%.9g,%.9g", static_cast<double>(v->x),
                                  static_cast<double>(v->y), static_cast<double>(v->z));
                    text += three;
                }
            text += '\n';
        }
        return text;
    }

    const std::vector<RunningBody>& bodies() const { return bodies_; }
    const TickTimes& times() const { return times_; }
    TickTimes& times() { return times_; }

private:
    static std::string at(double time) {
        char text[48];
        std::snprintf(text, sizeof text, "at t = %.9g s", time);
        return text;
    }

    void move(RunningBody& body, double time) {
        frm_pose pose{};
        frm_twist twist{};
        if (body.device) {
            frm_device_command command{};
            command.struct_size = sizeof command;
            command.wrench = body.forces.total;
            frm_device_state state{};
            state.struct_size = sizeof state;
            session_.check(frm_device_exchange(body.device, &command, &state), body.scene->where + ", " + at(time));
            pose = state.pose;
            twist = state.twist;
        } else {
            body.scene->motion.at(time, pose, twist);
        }
        session_.check(frm_body_set_motion(body.body, &pose, &twist), body.scene->where + ", " + at(time));
    }

    const Scene& scene_;
    Session session_;
    frm_world world_ = 0;
    frm_recorder recorder_ = 0;
    std::string recording_;
    std::vector<RunningBody> bodies_;
    TickTimes times_;
};

nlohmann::ordered_json summary(const Scene& scene, const Run& run, const Options& o, const std::string& recording) {
    nlohmann::ordered_json j;
    j["scene"] = scene.title;
    j["ticks"] = run.times().count();
    j["dt"] = scene.dt;
    j["seconds"] = static_cast<double>(run.times().count()) * scene.dt;
    j["tick_seconds"] = 1e-6 * run.times().mean() * static_cast<double>(run.times().count());
    j["world_hash"] = hash_text(run.hash());
    j["bodies"] = nlohmann::ordered_json::array();
    for (const RunningBody& b : run.bodies())
        j["bodies"].push_back({{"name", b.scene->name},
                               {"map", scene.maps.at(b.scene->map)},
                               {"peak_force", b.peak_force},
                               {"peak_force_time", b.peak_time},
                               {"peak_torque", b.peak_torque}});
    j["tick_us"] = run.times().json();
    j["recording"] = recording;
    j["command"] = "frm run " + o.scene;
    return j;
}

constexpr const char* csv_head =
    "time,body,fx,fy,fz,tx,ty,tz,buoyancy_fx,buoyancy_fy,buoyancy_fz,buoyancy_tx,buoyancy_ty,buoyancy_tz,pressure_fx,"
    "pressure_fy,"
    "pressure_fz,pressure_tx,pressure_ty,pressure_tz,friction_fx,friction_fy,friction_fz,friction_tx,friction_ty,"
    "friction_tz,"
    "gravity_fx,gravity_fy,gravity_fz,gravity_tx,gravity_ty,gravity_tz\n";

void print(const Scene& scene, const Run& run, const nlohmann::ordered_json& result) {
    std::printf("%s: %zu ticks of %g ms, world hash %s\n", scene.title.c_str(), run.times().count(), 1e3 * scene.dt,
                result["world_hash"].get<std::string>().c_str());
    for (const RunningBody& b : run.bodies())
        std::printf("%s: largest force %.4g N at %.3f s, largest torque %.4g N m\n", b.scene->name.c_str(),
                    b.peak_force, b.peak_time, b.peak_torque);
    std::printf("tick: median %.1f us, 99 %% under %.1f us, longest %.1f us\n", run.times().quantile(0.5),
                run.times().quantile(0.99), run.times().quantile(1));
    const std::string recording = result["recording"];
    if (!recording.empty()) std::printf("recorded in %s\n", recording.c_str());
}

/// No output may be another, or what the scene is made of.
void require_outputs(const Scene& scene, const Options& o, const std::string& recording) {
    std::vector<std::string> outputs{recording, o.csv}, inputs{o.scene};
    for (const char* name : {"/run.json", "/report.html"})
        if (!o.report.empty()) outputs.push_back(o.report + name);
    for (const auto& [name, path] : scene.maps) inputs.push_back(path);
    for (const SceneBody& body : scene.bodies) inputs.push_back(recording_of(body.motion.device()));
    require_distinct(outputs, inputs);
    if (!o.csv.empty()) require_writable(o.csv);
    if (!o.record.empty()) require_writable(o.record);
    if (!o.report.empty()) require_report_tools();
}

/// All ticks, or as many as there are before Ctrl-C.
void tick_all(Run& run, double dt, std::size_t ticks, OutputFile* csv) {
    run.times().reserve(std::min<std::size_t>(ticks, 1 << 20));
    if (csv) csv->write(csv_head);
    ProgressBar bar("run");
    for (std::size_t n = 0; n < ticks; ++n) {
        const double time = static_cast<double>(n) * dt;
        run.tick(time);
        if (csv) csv->write(run.csv_rows(time));
        if (n % 64 == 0 &&
            !bar.update(static_cast<double>(n) / static_cast<double>(ticks), "t = " + std::to_string(time) + " s"))
            break;
    }
}

void run(const Options& o) {
    Scene scene = read_scene(o.scene, o.maps, o.preset);
    if (o.seconds > 0) scene.seconds = o.seconds;
    const double ticks = std::round(scene.seconds / scene.dt);
    if (!(ticks >= 1 && ticks <= 1e9)) throw Failure(o.scene + ": seconds / dt must be 1 to 1e9 ticks");
    const std::string recording = !o.record.empty() ? o.record : !o.report.empty() ? o.report + "/run.frmrec" : "";
    require_outputs(scene, o, recording);

    Run run(scene);
    if (!o.report.empty()) make_folder(o.report);
    if (!recording.empty()) run.record(recording);
    const std::unique_ptr<OutputFile> csv = o.csv.empty() ? nullptr : std::make_unique<OutputFile>(o.csv);
    tick_all(run, scene.dt, static_cast<std::size_t>(ticks), csv.get());
    run.close();
    if (csv) csv->commit();
    const nlohmann::ordered_json result = summary(scene, run, o, recording);
    if (o.json)
        std::printf("%s\n", result.dump(2).c_str());
    else
        print(scene, run, result);
    std::fflush(stdout);
    if (interrupted()) {
        std::fprintf(stderr, "frm: interrupted after %zu of %.0f ticks\n", run.times().count(), ticks);
        throw Unsuccessful();
    }
    if (o.report.empty()) return;
    write_file(o.report + "/run.json", result.dump(2) + "\n");
    write_report(recording, o.report + "/run.json", o.report + "/report.html");
    if (!o.json) std::printf("report in %s/report.html\n", o.report.c_str());
}

}  // namespace

void add_run(CLI::App& app) {
    auto options = std::make_shared<Options>();
    Options& o = *options;
    CLI::App* command = app.add_subcommand("run", "Runs a scene: bodies with maps, moved through water, tick by tick.");
    command->footer(
        "docs/scene.md says what a scene holds.\n"
        "  frm run samples/paddle_stroke.json --map paddle=paddle.frm --report out");
    command->add_option("SCENE", o.scene, "a scene file (JSON)")->required()->check(not_empty())->type_name("");
    command->add_option("--map", o.maps, "where a map of the scene is; may be repeated")
        ->expected(1)
        ->take_all()
        ->type_name("NAME=FILE");
    command
        ->add_option("--preset", o.preset,
                     "fast: cells of twice the size; accurate: fourth order (docs/performance.md). Goes before\n"
                     "the scene's own")
        ->check(one_of({"fast", "default", "accurate"}))
        ->type_name("fast|default|accurate");
    command->add_option("--record", o.record, "write a recording that frm replay checks bit for bit")
        ->check(not_empty())
        ->type_name("FILE");
    command
        ->add_option("--report", o.report, "write report.html and run.json to this folder (needs python3-matplotlib)")
        ->check(not_empty())
        ->type_name("DIR");
    command->add_option("--csv", o.csv, "write the wrench and its parts of every tick to this file")
        ->check(not_empty())
        ->type_name("FILE");
    command->add_option("--seconds", o.seconds, "run so long instead of as long as the scene says")
        ->check(positive())
        ->type_name("S");
    command->add_flag("--json", o.json, "JSON on standard output");
    command->callback([options] { run(*options); });
}

}  // namespace frm::cli
