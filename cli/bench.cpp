// frm bench: what a tick and its parts cost here, on a map made from a formula.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>

#include "bake/flow/speed.h"
#include "bake/map/formula.h"
#include "bake/regions/tessellate.h"
#include "cli/command.h"
#include "cli/frm_object.h"
#include "cli/tick_times.h"
#include "core/map/codec.h"

namespace frm::cli {
namespace {

struct Options {
    double seconds = 1;
    bool json = false;
};

struct Result {
    const char* name;
    double value;
    const char* unit;
    const char* what;
};

/// A thin box, tessellated, as the paper's paddle is: `triangles` at most.
std::vector<std::uint8_t> box_map(std::uint32_t sources, std::uint32_t triangles) {
    bake::Surface box;
    for (int i = 0; i < 8; ++i) box.vertices.emplace_back(i & 1 ? 0.1 : -0.1, i & 2 ? 0.01 : -0.01, i & 4 ? 0.3 : -0.3);
    for (const bake::Triangle& t : {bake::Triangle{0, 2, 1},
                                    {1, 2, 3},
                                    {4, 5, 6},
                                    {5, 7, 6},
                                    {0, 1, 4},
                                    {1, 5, 4},
                                    {2, 6, 3},
                                    {3, 6, 7},
                                    {0, 4, 2},
                                    {2, 4, 6},
                                    {1, 3, 5},
                                    {3, 7, 5}})
        box.triangles.push_back(t);
    return encode_map(bake::formula_map(bake::tessellate(box, 1e-4, triangles).surface, sources, 4, 128));
}

struct Setting {
    std::uint32_t cells = 200;  ///< 0: no water
    double height = 0;
    bool moving = true;
    std::uint32_t bodies = 1;
};

/// Ticks of 2 ms for `seconds` of wall time.
TickTimes measure(const std::vector<std::uint8_t>& map_file, const Setting& setting, double seconds) {
    const Session session;
    frm_world world = 0;
    session.check(frm_world_create(session.context(), nullptr, &world));
    if (setting.cells > 0) {
        frm_water_def water_def;
        session.check(frm_water_def_init(&water_def, sizeof water_def));
        water_def.nx = water_def.ny = setting.cells;
        frm_water water = 0;
        session.check(frm_water_create(world, &water_def, &water));
    }
    std::vector<frm_body> bodies;
    if (setting.bodies > 0) {
        frm_map map = 0;
        session.check(frm_map_open_memory(session.context(), map_file.data(), map_file.size(), &map));
        frm_body_def def;
        session.check(frm_body_def_init(&def, sizeof def));
        def.map = map;
        def.mass = 1;
        for (std::uint32_t i = 0; i < setting.bodies; ++i) {
            frm_body body = 0;
            session.check(frm_body_create(world, &def, &body));
            bodies.push_back(body);
        }
    }
    TickTimes times;
    const auto now = [] { return std::chrono::steady_clock::now(); };
    const auto begin = now();
    for (std::size_t n = 0; n < 100 || std::chrono::duration<double>(now() - begin).count() < seconds; ++n) {
        const double phase = 0.002 * static_cast<double>(n) * 2;
        for (const frm_body body : bodies) {
            frm_pose pose{{0.3 * std::sin(phase), 0, setting.height}, {0, 0, 0, 1}};
            pose.rotation = {static_cast<float>(std::sin(0.2 * std::sin(phase))), 0, 0,
                             static_cast<float>(std::cos(0.2 * std::sin(phase)))};
            const frm_twist twist{{static_cast<float>(0.6 * std::cos(phase)), 0.4f, 0}, {0, 0, 0}};
            session.check(frm_body_set_motion(body, &pose, setting.moving ? &twist : nullptr));
        }
        const auto start = now();
        session.check(frm_world_tick(world, 0.002f));
        const double us = std::chrono::duration<double, std::micro>(now() - start).count();
        if (n >= 50) times.add(us);
    }
    return times;
}

void run(const Options& o) {
    const std::vector<std::uint8_t> large = box_map(40, 2000), small = box_map(26, 1000);
    std::vector<Result> results;
    const auto add = [&](const char* name, double value, const char* unit, const char* what) {
        results.push_back({name, value, unit, what});
    };

    const TickTimes tick200 = measure(large, {200, 0, true, 1}, o.seconds);
    add("tick_200_us_median", tick200.quantile(0.5), "us",
        "two-way tick, 200 x 200 water, 40 sources, 2,000 triangles, half wet");
    add("tick_200_us_p99", tick200.quantile(0.99), "us", "the same, 99 % of the ticks");
    add("tick_128_us_median", measure(small, {128, 0, true, 1}, o.seconds).quantile(0.5), "us",
        "two-way tick, 128 x 128 water, 26 sources, 1,000 triangles");
    const double wave = measure(large, {200, 0, false, 0}, o.seconds).quantile(0.5);
    add("wave_200_us", wave, "us", "wave step of 200 x 200 cells");
    add("wave_cell_ns", 1e3 * wave / 40000, "ns", "a cell of it");
    const double moving = measure(large, {0, -1, true, 1}, o.seconds).quantile(0.5);
    const double still = measure(large, {0, -1, false, 1}, o.seconds).quantile(0.5);
    add("submerged_body_us", moving, "us", "body under flat water: 2,000 triangles and 40 sources");
    add("lookup_ns_per_source", 1e3 * (moving - still) / 40, "ns", "what its motion adds, a source");
    add("triangle_ns", 1e3 * still / 2000, "ns", "a triangle of it at rest");
    add("dry_body_us", measure(large, {0, 10, true, 1}, o.seconds).quantile(0.5), "us", "body above the water");

    const bake::FlowSpeed flow = bake::measure_flow_speed(o.seconds, 0);
    add("flow_inplace_bandwidth", flow.bandwidth, "GB/s", "memory read and written in place, all cores");
    add("flow_kernel_mlups", flow.kernel, "M/s", "flow: cell updates in the interior of a large block");
    add("flow_kernel_roof_share", flow.kernel / flow.roof, "", "of what that bandwidth allows at 152 bytes a cell");
    add("flow_nested_mlups", flow.nested, "M/s", "flow: cell updates of a whole run in nested blocks");
    add("flow_nested_share", flow.nested / flow.kernel, "", "of the interior's");

    if (o.json) {
        nlohmann::ordered_json j;
        for (const Result& r : results)
            j["results"].push_back({{"name", r.name}, {"value", r.value}, {"unit", r.unit}});
        std::printf("%s\n", j.dump(2).c_str());
    } else {
        for (const Result& r : results) std::printf("%-22s %9.3f %-4s %s\n", r.name, r.value, r.unit, r.what);
    }
}

}  // namespace

void add_bench(CLI::App& app) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        app.add_subcommand("bench", "Measures what a tick and its parts cost on this machine, on one core, and the flow\nsolver on all.");
    command->add_option("--seconds", options->seconds, "of ticks, for each figure")
        ->check(number_within(1e-3, 3600))
        ->type_name("S")
        ->capture_default_str();
    command->add_flag("--json", options->json, "JSON on standard output");
    command->callback([options] { run(*options); });
}

}  // namespace frm::cli
