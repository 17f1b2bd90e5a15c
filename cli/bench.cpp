// frm bench: what a tick and its parts cost on this machine, beside what was asked for and what others cost.
#include <cstdio>
#include <memory>
#include <optional>

#include "bake/flow/speed.h"
#include "cli/bench_body.h"
#include "cli/bench_lookup.h"
#include "cli/bench_mujoco.h"
#include "cli/bench_record.h"
#include "cli/bench_spidar.h"
#include "cli/bench_tick.h"
#include "cli/bench_waves.h"
#include "cli/command.h"
#include "cli/frontier.h"

namespace frm::cli {
namespace {

struct Options {
    double seconds = 1;
    bool full = false;
    bool json = false;
};

struct Result {
    const char* name;
    double value;
    const char* unit;
    const char* what;
    std::optional<double> limit;  ///< what is asked for, in the same unit
};

class Results {
public:
    explicit Results(bool json) : json_(json) {}

    void add(const char* name, double value, const char* unit, const char* what, std::optional<double> limit = {}) {
        results_.push_back({name, value, unit, what, limit});
        if (json_) return;
        std::printf("%-28s %10.4g %-4s %s", name, value, unit, what);
        if (limit) std::printf(" (asked: %g)", *limit);
        std::printf("\n");
        std::fflush(stdout);
    }
    nlohmann::ordered_json json() const {
        nlohmann::ordered_json list = nlohmann::ordered_json::array();
        for (const Result& r : results_) {
            list.push_back({{"name", r.name}, {"value", r.value}, {"unit", r.unit}});
            if (r.limit) list.back().update({{"limit", *r.limit}, {"ratio", r.value / *r.limit}});
        }
        return {{"results", list}};
    }

private:
    bool json_;
    std::vector<Result> results_;
};

void ticks(const Options& o, const std::vector<std::uint8_t>& large, Results& out) {
    const auto median = [&](const std::vector<std::uint8_t>& map, const TickScene& scene) {
        return measure_ticks(map, scene, o.seconds).quantile(0.5);
    };
    TickScene scene;
    const TickTimes whole =
        o.full ? measure_ticks(large, scene, 3600, 1000000) : measure_ticks(large, scene, 4 * o.seconds);
    out.add("tick_200_us_median", whole.quantile(0.5), "us",
            "two-way tick, 200 x 200 water, 40 sources, 2,000 triangles, half wet", 10);
    out.add("tick_200_us_p99", whole.quantile(0.99), "us", "the same, 99 % of the ticks");
    out.add("tick_200_us_p9999", whole.quantile(0.9999), "us",
            o.full ? "the same, 99.99 % of a million ticks" : "the same, 99.99 % of the ticks (a million with --full)",
            30);
    scene.dt = 0.0002;
    out.add("tick_5khz_us_mean", measure_ticks(large, scene, o.seconds).mean(), "us",
            "the mean at 5 kHz, where ticks share wave steps");
    scene.dt = 0.002;
    scene.cells = 128;
    out.add("tick_128_us_median", median(bench_map(26, 1000), scene), "us",
            "two-way tick, 128 x 128 water, 26 sources, 1,000 triangles", 6);
    out.add("submerged_body_us", median(large, {0, 1, 0, -1}), "us",
            "tick of a body under flat water: 2,000 triangles and 40 sources");

    // Of a thousand bodies, so that the clock and the call do not count.
    const double none = median(large, {200, 0}), dry = median(large, {200, 0, 1000});
    out.add("dry_body_ns", dry - none, "ns", "a body far above the water", 50);
    const double ten = median(large, {200, 10}), thousand = median(large, {200, 10, 990});
    out.add("ten_bodies_us", ten, "us", "tick of ten bodies in 200 x 200 water");
    out.add("thousand_bodies_us", thousand - ten, "us", "what 990 more add that are far above it", 50);
}

void parts(const Options& o, const std::vector<std::uint8_t>& large, Results& out) {
    const BodyTimes body = measure_body(large, o.seconds);
    out.add("body_cut_us", body.cut, "us", "wet surface of 2,000 triangles, half wet in waves");
    out.add("body_wet_us", body.wet, "us", "the same, wholly wet under waves");
    out.add("body_calm_us", body.calm, "us", "the same, wholly wet under calm water");
    out.add("body_displacement_us", body.displacement, "us", "its displaced volume, half wet");
    out.add("body_still_us", body.still, "us", "the same, of a body that has not moved");
    out.add("body_coupling_us", body.coupling, "us", "that into the water and its own waves");

    const LookupTimes lookup = measure_lookup(large, o.seconds);
    out.add("lookup_ns_per_source", lookup.source, "ns", "Eq. 6 and all around it for 40 sources of a stroke, each",
            15);
    out.add("lookup_scattered_ns", lookup.scattered, "ns", "the same, each tick in another direction");
    const std::optional<MujocoFluid> mujoco = measure_mujoco(o.seconds);
    out.add("coarse_body_ns", lookup.coarse, "ns", "a submerged body as one group of sources",
            mujoco ? std::optional(mujoco->nanoseconds) : std::nullopt);
    if (!mujoco) return;
    out.add("mujoco_ellipsoid_ns", mujoco->nanoseconds, "ns", "MuJoCo's ellipsoid fluid model, a geom");
    out.add("mujoco_plate_cd", mujoco->plate_drag, "",
            "its drag coefficient of a box 8 x 1 x 30 face-on (Hoerner: 1.19)");
}

void waves(const Options& o, Results& out) {
    const auto share = [&](const char* name, std::int32_t cells, const char* what) {
        const WaveSpeed speed = measure_wave_speed(cells, 2, 1, o.seconds);
        out.add(name, speed.roof_share(), "", what, 0.75);
        return speed;
    };
    share("wave_128_roof_share", 128, "wave step of 128 x 128 cells, of what its bytes take in place in the cache");
    const WaveSpeed speed = share("wave_200_roof_share", 200, "the same, 200 x 200");
    share("wave_256_roof_share", 256, "the same, 256 x 256");
    share("wave_512_roof_share", 512, "the same, 512 x 512");
    out.add("wave_200_cell_ns", speed.cell_ns(), "ns", "a cell of 200 x 200, second order in space");
    out.add("wave_200_cell_4_ns", measure_wave_speed(200, 4, 1, o.seconds).cell_ns(), "ns", "the same, fourth order");
    out.add("wave_2048_stream_ratio", measure_wave_speed(2048, 2, 8, 2 * o.seconds).roof_share(), "",
            "steps of 2048 x 2048 cells, eight a tick, against their bytes streamed from memory", 2);
    out.add("wave_active64_us", measure_active_waves(2, o.seconds), "us",
            "step of 64 x 64 cells with waves in 2048 x 2048", 3);
}

void recording(const Options& o, const std::vector<std::uint8_t>& large, Results& out) {
    const RecordCost cost = measure_recording(large, o.seconds);
    out.add("record_us_per_tick", cost.us_per_tick, "us",
            "recording a body, its device and packets of 512 bytes, in the thread that ticks", 2);
    out.add("record_kb_per_s", cost.kb_per_s, "kB/s", "the same at 1 kHz, on the disk: hand, water, 60 bytes of packet",
            64);
    out.add("record_lost_events", cost.lost, "", "for which there was no room meanwhile");
}

void spidar(const Options& o, Results& out) {
    const SpidarTimes times = measure_spidar(o.seconds);
    out.add("spidar_pose_us", times.pose, "us", "SPIDAR-G: pose from eight lengths at 1 m/s and 1 kHz", 10);
    out.add("spidar_tensions_us", times.tensions, "us", "SPIDAR-G: tensions of a wrench that changes as the grip moves",
            20);
    out.add("spidar_tensions_worst_us", times.tensions_worst, "us",
            "the same of wrenches that jump, half of them out of reach, 99 %", 20);
}

void flow(const Options& o, Results& out) {
    const bake::FlowSpeed speed = bake::measure_flow_speed(o.seconds, 0);
    out.add("flow_inplace_bandwidth", speed.bandwidth, "GB/s", "memory read and written in place, all cores");
    out.add("flow_kernel_mlups", speed.kernel, "M/s", "flow: cell updates in the interior of a large block");
    out.add("flow_kernel_roof_share", speed.kernel / speed.roof, "",
            "of what that bandwidth allows at 152 bytes a cell", 0.45);
    out.add("flow_nested_mlups", speed.nested, "M/s", "flow: cell updates of a whole run in nested blocks");
    out.add("flow_nested_share", speed.nested / speed.kernel, "", "of the interior's", 0.6);
}

void run(const Options& o) {
    Results results(o.json);
    const std::vector<std::uint8_t> large = bench_map(40, 2000);
    ticks(o, large, results);
    parts(o, large, results);
    waves(o, results);
    recording(o, large, results);
    spidar(o, results);
    flow(o, results);
    if (o.json) std::printf("%s\n", results.json().dump(2).c_str());
}

}  // namespace

void add_bench(CLI::App& app) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand(
        "bench", "Measures what a tick and its parts cost on this machine, on one core, and the flow\nsolver on all.");
    command->add_option("--seconds", options->seconds, "of ticks, for each figure")
        ->check(number_within(1e-3, 3600))
        ->type_name("S")
        ->capture_default_str();
    command->add_flag("--full", options->full, "a million ticks for the 99.99th percentile");
    command->add_flag("--json", options->json, "JSON on standard output");
    add_frontier(*command);
    // Before the frontier is measured: what stands left of it would be passed over.
    command->parse_complete_callback([command] {
        if (command->get_subcommands().empty()) return;
        for (const CLI::Option* option : command->get_options())
            if (option->count() > 0) throw CLI::ExtrasError({option->get_name() + ": belongs after frontier"});
    });
    command->callback([options, command] {
        if (command->get_subcommands().empty()) run(*options);
    });
}

}  // namespace frm::cli
