#include "cli/frontier.h"

#include <algorithm>
#include <memory>

#include "cli/bench_mujoco.h"
#include "cli/command.h"
#include "cli/frm_object.h"
#include "cli/frontier_buoyancy.h"
#include "cli/frontier_report.h"
#include "cli/frontier_scenes.h"

namespace frm::cli {
namespace {

constexpr double tick_at_500_hz = 0.002;

struct Options {
    std::vector<std::string> scenes, maps;
    std::uint32_t repeats = 5;
    bool quick = false;
    bool json = false;
};

Errors errors_of(const Readings& readings, const Readings& reference) {
    const ForceError e = error_of(readings, reference);
    return {{"force", e.force}, {"torque", e.torque}};
}

/// The ratio of two settings' times, repeat by repeat, for what both cost at 500 Hz.
void set_ratio(FrontierRow& row, const std::vector<double>& us, const std::vector<double>& standard, double per_tick) {
    std::vector<double> ratios;
    for (std::size_t r = 0; r < us.size(); ++r) ratios.push_back(per_tick * us[r] / standard[r]);
    row.ratio = quantile_of(ratios, 0.5);
    row.low = quantile_of(ratios, 0.25);
    row.high = quantile_of(ratios, 0.75);
}

FrontierRow row_of(const Knob& knob, const Choice& choice, const Play& play) {
    FrontierRow row;
    row.knob = knob.name;
    row.label = choice.label;
    row.value = choice.value;
    row.standard = choice.standard;
    row.dt = choice.setup.dt;
    row.tick_us = play.tick_us;
    row.us_at_500_hz = play.tick_us * tick_at_500_hz / choice.setup.dt;
    if (choice.setup.map) row.map_bytes = choice.setup.map->size();
    return row;
}

/// The settings of one knob and the default, in turns.
void play_knob(const FrontierScene& scene, const Knob& knob, const Play* finest, std::uint32_t repeats,
               FrontierTable& table) {
    std::vector<const Setup*> setups{&scene.standard};
    std::vector<std::size_t> place;
    for (const Choice& choice : knob.choices) {
        place.push_back(choice.standard ? 0 : setups.size());
        if (!choice.standard) setups.push_back(&choice.setup);
    }
    const std::vector<Play> plays = play_in_turns(scene.play, setups, repeats);
    if (!finest && !plays[0].readings.empty()) {
        const Peak peak = peak_of(plays[0].readings);
        table.peak_force = peak.force;
        table.peak_torque = peak.torque;
    }
    for (std::size_t k = 0; k < knob.choices.size(); ++k) {
        const Play& play = plays[place[k]];
        FrontierRow row = row_of(knob, knob.choices[k], play);
        set_ratio(row, play.repeat_us, plays[0].repeat_us, scene.standard.dt / row.dt);
        if (play.waves) row.exact = Errors{{"height", *play.waves}};
        if (!play.readings.empty() && knob.by_itself)
            row.knob_finest = errors_of(play.readings, plays[place.back()].readings);
        if (finest) row.finest = errors_of(play.readings, finest->readings);
        table.rows.push_back(std::move(row));
    }
}

/// Knobs are played one after the other, and the machine may be faster for one than for the next. The default is in all of
/// them: by the ratio to it all times become those of one and the same.
void level_times(FrontierTable& table) {
    std::vector<double> standard;
    for (const FrontierRow& row : table.rows)
        if (row.standard) standard.push_back(row.us_at_500_hz);
    const double us = quantile_of(standard, 0.5);
    for (FrontierRow& row : table.rows) {
        row.us_at_500_hz = row.ratio * us;
        row.tick_us = row.us_at_500_hz * row.dt / tick_at_500_hz;
    }
}

FrontierTable play_scene(const FrontierScene& scene, std::uint32_t repeats) {
    FrontierTable table{
        scene.play.name, scene.what, scene.reference, scene.play.exact_height ? "height" : "force", 0, 0, {}};
    std::vector<Play> finest;
    if (!scene.finest.empty()) {
        finest = play_in_turns(scene.play, {&scene.finest.front()}, 1);
        const Peak peak = peak_of(finest[0].readings);
        table.peak_force = peak.force;
        table.peak_torque = peak.torque;
    }
    for (const Knob& knob : scene.knobs) play_knob(scene, knob, finest.empty() ? nullptr : &finest[0], repeats, table);
    level_times(table);
    return table;
}

FrontierTable play_buoyancy(bool waves, std::uint32_t repeats, bool quick) {
    FrontierTable table;
    table.scene = waves ? "buoyancy in waves" : "buoyancy";
    table.what = waves
                     ? "buoyancy alone: a hull (ellipsoid of 1.2 x 0.5 x 0.4 m) in waves twice as long, 64 cells each, "
                       "steepness 0.2"
                     : "buoyancy alone: a hull (ellipsoid of 1.2 x 0.5 x 0.4 m) that heaves and rolls in calm water";
    table.reference = waves ? "32,768 triangles in the same waves" : "";
    table.error_of = "force";
    const BuoyancyScene scene = measure_buoyancy(waves, repeats, quick);
    const Peak peak = peak_of(scene.reference);
    table.peak_force = peak.force;
    table.peak_torque = peak.torque;
    const auto standard = std::find_if(scene.ways.begin(), scene.ways.end(), [](const auto& w) { return w.standard; });
    for (const BuoyancyWay& way : scene.ways) {
        FrontierRow row;
        row.knob = way.knob;
        row.value = way.value;
        row.label = std::to_string(static_cast<long>(way.value));
        row.standard = way.standard;
        row.peer = way.knob != "triangles";
        row.dt = tick_at_500_hz;
        row.tick_us = row.us_at_500_hz = way.us;
        set_ratio(row, way.repeat_us, standard->repeat_us, 1);
        (waves ? row.finest : row.exact) = errors_of(way.readings, scene.reference);
        table.rows.push_back(std::move(row));
    }
    return table;
}

/// MuJoCo's box, as large as the map's, along the scene's motion.
void add_mujoco(const FrontierScene& scene, std::uint32_t repeats, FrontierTable& table) {
    const Session session;
    frm_map map = 0;
    const MapFile& file = scene.standard.map;
    session.check(frm_map_open_memory(session.context(), file->data(), file->size(), &map));
    const frm_map_info info = session.map_info(map);
    const auto half = [](float low, float high) { return 0.5 * static_cast<double>(high - low); };
    const Vec3d half_sizes(half(info.bounds_low.x, info.bounds_high.x), half(info.bounds_low.y, info.bounds_high.y),
                           half(info.bounds_low.z, info.bounds_high.z));
    std::vector<std::pair<frm_pose, frm_twist>> motion;
    // When play_in_turns() looks.
    for (long n = 0; static_cast<double>(n) * scene.play.sample < scene.play.seconds - 1e-9; ++n) {
        const double time = static_cast<double>(n) * scene.play.sample;
        if (!(time > scene.play.settle)) continue;
        motion.emplace_back();
        scene.play.motion(time, 0, motion.back().first, motion.back().second);
    }
    const frm_world_def& world = scene.standard.world;
    const std::optional<MujocoMotion> moved = move_mujoco(half_sizes, motion, static_cast<double>(world.density),
                                                          static_cast<double>(world.viscosity), 0.1 * repeats);
    if (!moved) return;
    const Play reference = play_in_turns(scene.play, {&scene.standard}, 1)[0];
    FrontierRow row;
    row.knob = "MuJoCo";
    row.label = "ellipsoid model";
    row.peer = true;
    row.dt = tick_at_500_hz;
    row.tick_us = row.us_at_500_hz = 1e-3 * moved->nanoseconds;
    row.ratio = row.low = row.high = row.tick_us / reference.tick_us;
    row.knob_finest = errors_of(moved->readings, reference.readings);
    table.rows.push_back(std::move(row));
}

const std::vector<std::string>& scene_names() {
    static const std::vector<std::string> names = [] {
        std::vector<std::string> all = kPlayedScenes;
        all.insert(all.end(), {"buoyancy", "buoyancy-waves", "maps"});
        return all;
    }();
    return names;
}

void run(const Options& o) {
    std::vector<std::string> scenes = o.scenes;
    if (scenes.empty())
        for (const std::string& name : scene_names())
            if (name != "maps" || !o.maps.empty()) scenes.push_back(name);
    if (std::find(scenes.begin(), scenes.end(), "maps") != scenes.end() && o.maps.size() < 2)
        throw Failure("--scene maps: needs two maps of one body or more, from coarse to fine: --map FILE --map FILE");
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const std::string& name : scenes) {
        FrontierTable table;
        if (name == "buoyancy" || name == "buoyancy-waves") {
            table = play_buoyancy(name != "buoyancy", o.repeats, o.quick);
        } else if (name == "maps") {
            const FrontierScene scene = make_map_scene(o.maps);
            table = play_scene(scene, o.repeats);
            add_mujoco(scene, o.repeats, table);
        } else {
            table = play_scene(make_scene(name, o.quick), o.repeats);
        }
        table.mark_frontier();
        if (o.json)
            all.push_back(table.json());
        else
            table.print();
    }
    if (!o.json) return;
    const nlohmann::ordered_json j{{"version", 1}, {"repeats", o.repeats}, {"quick", o.quick}, {"scenes", all}};
    std::printf("%s\n", j.dump(1).c_str());
}

}  // namespace

void add_frontier(CLI::App& bench) {
    auto options = std::make_shared<Options>();
    Options& o = *options;
    CLI::App* command = bench.add_subcommand("frontier", "Run time against error of every setting, in several scenes.");
    command->footer(
        "Errors are against the finest setting and, where there is one, the exact answer; MuJoCo's\n"
        "ellipsoid model and point-sampled buoyancy are beside it. docs/performance.md has what it\n"
        "found and says how to read it.");
    command
        ->add_option("--scene", o.scenes,
                     "only this one: stroke, boat, tow, crowd, waves, buoyancy, buoyancy-waves or maps; may be\n"
                     "repeated (default: all; maps with --map)")
        ->expected(1)
        ->take_all()
        ->check(one_of(scene_names()))
        ->type_name("NAME");
    command
        ->add_option("--map", o.maps,
                     "a map of the body of the scene maps; repeat it from coarse to fine: the last is\n"
                     "what the others are compared with")
        ->expected(1)
        ->take_all()
        ->check(not_empty())
        ->type_name("FILE");
    command->add_option("--repeats", o.repeats, "of each scene with each setting, in turns")
        ->check(whole_within(1, 1000))
        ->type_name("N")
        ->capture_default_str();
    command->add_flag("--quick", o.quick, "seconds: smaller scenes, the ends of each range");
    command->add_flag("--json", o.json, "JSON on standard output");
    command->callback([options] { run(*options); });
}

}  // namespace frm::cli
