#include "bake/bake.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "bake/directions.h"
#include "bake/map/fill.h"
#include "bake/mesh/gltf.h"
#include "bake/mesh/repair.h"
#include "bake/regions/regions.h"
#include "bake/regions/tessellate.h"
#include "bake/series/periodic.h"
#include "core/math/hash.h"

namespace frm::bake {
namespace {

struct Preset {
    std::uint32_t directions, sources;
    double cells, start_up, period;  ///< cells and lengths in reference lengths
};

Preset preset(Quality quality) {
    switch (quality) {
        case Quality::draft:
            return {18, 40, 12, 6, 8};
        case Quality::high:
            return {102, 80, 36, 12, 40};
        default:
            return {38, 40, 24, 10, 20};
    }
}

constexpr double overlap_share = 0.25;        ///< of the period, faded into its beginning
constexpr double harmonics_per_length = 2;    ///< kept: shedding is at 0.1 to 0.2 a length, so ten of its harmonics
constexpr double amplitude_threshold = 2e-4;  ///< of the mean force on the whole object: harmonics below are dropped
constexpr double quantisation_budget = 2e-3;  ///< of the peak force
constexpr double longest_edges = 24;  ///< the sample triangles' longest edge: the bounding box's diagonal over this

std::string mesh_hash(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    char text[20];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(fnv1a(bytes.data(), bytes.size())));
    return text;
}

void require(bool good, const std::string& text) {
    if (!good) throw BakeError(text);
}

/// One direction's series, [samples][regions][3], made periodic source by source and component by component; the means
/// go to the map's place for this direction.
Fluctuation add_direction(Map& map, std::size_t direction, const FlowSeries& flow, const BakePlan& plan, double speed) {
    const std::uint32_t regions = flow.regions;
    // The solver's interval is a whole number of its steps, so that a period is a whole number of intervals only
    // nearly.
    const double period_time = plan.period * plan.reference_length / speed;
    const auto period_samples = 2 * static_cast<std::uint32_t>(std::lround(0.5 * period_time / flow.interval));
    Vec3d whole;
    for (std::size_t i = 0; i < flow.pressure.size(); ++i)
        whole[static_cast<int>(i % 3)] += static_cast<double>(flow.pressure[i] + flow.friction[i]) / flow.samples;
    const PeriodicSpec spec{std::min(period_samples, flow.samples / 2 * 2), plan.samples, plan.harmonics,
                            amplitude_threshold * length(whole) / std::sqrt(static_cast<double>(regions))};

    Fluctuation out(std::size_t{regions} * plan.samples * Map::components);
    std::vector<float> signal(flow.samples);
    for (std::uint32_t l = 0; l < regions; ++l) {
        SourceForce& mean = map.mean[direction * regions + l];
        for (std::uint32_t c = 0; c < Map::components; ++c) {
            const std::vector<float>& from = c < 3 ? flow.pressure : flow.friction;
            for (std::uint32_t s = 0; s < flow.samples; ++s)
                signal[s] = from[(std::size_t{s} * regions + l) * 3 + c % 3];
            const PeriodicSeries series = make_periodic(signal, spec);
            (c < 3 ? mean.pressure : mean.friction)[static_cast<int>(c % 3)] = static_cast<float>(series.mean);
            for (std::uint32_t s = 0; s < plan.samples; ++s)
                out[(std::size_t{l} * plan.samples + s) * Map::components + c] = series.fluctuation[s];
        }
    }
    return out;
}

DirectionReport describe(const FlowSeries& flow, const FlowCase& flow_case) {
    double drag = 0;
    for (std::size_t i = 0; i < flow.pressure.size(); ++i)
        drag += static_cast<double>(flow.pressure[i] + flow.friction[i]) * flow_case.direction[static_cast<int>(i % 3)];
    drag /= flow.samples;
    const double unit = 0.5 * flow_case.density * flow_case.speed * flow_case.speed * flow.plan.projected_area;
    return {flow_case.direction, drag / unit, flow.uncertainty.total(), flow.seconds, flow.mlups};
}

// Wall time, thread count and machine are left out: the same mesh and options give the same file.
std::string provenance(const BakeOptions& options, const BakePlan& plan, const BakeReport& report) {
    nlohmann::ordered_json j;
    j["mesh"] = options.mesh.substr(options.mesh.find_last_of('/') + 1);
    j["mesh_hash"] = mesh_hash(options.mesh);
    j["quality"] = options.quality == Quality::draft ? "draft" : options.quality == Quality::high ? "high" : "standard";
    j["solver"] = "lattice Boltzmann D3Q19, regularised, Smagorinsky, interpolated bounce-back, nested blocks (docs/flow.md)";
    j["resolution"] = plan.cases.front().resolution;
    j["start_up_lengths"] = plan.start_up;
    j["period_lengths"] = plan.period;
    j["harmonics"] = plan.harmonics;
    j["notes"] = plan.notes;
    for (std::size_t d = 0; d < report.directions.size(); ++d) {
        const DirectionReport& r = report.directions[d];
        const FlowPlan& flow = plan.flows[d];
        j["directions"].push_back({{"direction", {r.direction.x, r.direction.y, r.direction.z}},
                                   {"drag_coefficient", r.drag_coefficient},
                                   {"uncertainty", r.uncertainty},
                                   {"projected_area", flow.projected_area},
                                   {"reynolds_solved", flow.reynolds_solved},
                                   {"blockage", flow.blockage},
                                   {"cells", flow.cells},
                                   {"steps", flow.steps}});
    }
    return j.dump();
}

}  // namespace

std::uint32_t frequency_of(std::uint32_t directions) {
    for (std::uint32_t n = 1; n <= 16; ++n)
        if (4 * n * n + 2 == directions) return n;
    return 0;
}

Surface load_surface(const std::string& path, std::vector<std::string>& notes) {
    Repaired repaired = repair(load_gltf(path), path);
    notes.insert(notes.end(), repaired.notes.begin(), repaired.notes.end());
    return std::move(repaired.surface);
}

BakePlan plan_bake(const BakeOptions& options) {
    const Preset p = preset(options.quality);
    BakePlan plan;
    const std::uint32_t count = options.directions ? options.directions : p.directions;
    const std::uint32_t frequency = frequency_of(count);
    require(frequency > 0, "--directions " + std::to_string(count) +
                               ": a direction set has 4 n^2 + 2 directions: 6, 18, 38, 66, 102, "
                               "146, ... up to 1026");
    plan.directions = DirectionSet(frequency);
    const std::uint32_t sources = options.sources ? options.sources : p.sources;
    require(sources <= Map::max_sources, "--sources " + std::to_string(sources) + ": at most 4096");
    const std::uint32_t most_triangles = options.triangles ? options.triangles : 2000;
    require(most_triangles <= Map::max_triangles, "--triangles: at most 2097152");

    const Surface surface = load_surface(options.mesh, plan.notes);
    const SurfaceProperties shape = measure(surface);
    plan.surface = tessellate(surface, length(shape.high - shape.low) / longest_edges, most_triangles).surface;
    plan.regions = split_regions(plan.surface, sources);

    double area = 0;
    for (std::uint32_t d = 0; d < plan.directions.count(); ++d)
        area += projected_area(surface, plan.directions.direction(d));
    plan.reference_length = std::sqrt(area / plan.directions.count());
    plan.start_up = p.start_up;
    plan.period = p.period;
    plan.overlap = overlap_share * p.period;
    plan.harmonics = static_cast<std::uint32_t>(harmonics_per_length * plan.period);
    plan.samples = good_length(2 * plan.harmonics + 2);

    for (std::uint32_t d = 0; d < plan.directions.count(); ++d) {
        FlowCase c;
        c.direction = plan.directions.direction(d);
        c.speed = options.speed;
        c.density = options.density;
        c.viscosity = options.viscosity;
        c.resolution = options.resolution > 0 ? options.resolution : p.cells;
        c.reference_length = plan.reference_length;
        c.start_up = plan.start_up;
        c.duration = plan.period + plan.overlap;
        plan.flows.push_back(plan_flow(plan.surface, c));
        plan.cell_updates += plan.flows.back().updates;
        const std::string& warning = plan.flows.back().warning;
        if (!warning.empty() && std::find(plan.notes.begin(), plan.notes.end(), warning) == plan.notes.end())
            plan.notes.push_back(warning);
        plan.cases.push_back(c);
    }
    return plan;
}

std::unique_ptr<Map> bake(const BakeOptions& options, const BakePlan& plan, const Progress& progress,
                          BakeReport& report) {
    const auto begin = std::chrono::steady_clock::now();
    auto map = std::make_unique<Map>();
    fill_surface(*map, plan.surface, plan.regions);
    map->directions = plan.directions;
    map->samples = plan.samples;

    const std::size_t directions = plan.cases.size();
    map->mean.resize(directions * plan.regions.count);
    std::vector<Fluctuation> fluctuations(directions);
    report.directions.resize(directions);
    double reynolds_solved = options.speed * plan.reference_length / options.viscosity;
    solve_directions(plan.surface, plan.regions, plan.cases, plan.flows, options.threads,
                     plan.cases.front().memory_limit, progress, [&](std::size_t d, const FlowSeries& flow) {
                         fluctuations[d] = add_direction(*map, d, flow, plan, options.speed);
                         report.directions[d] = describe(flow, plan.cases[d]);
                         reynolds_solved = std::min(reynolds_solved, flow.plan.reynolds_solved);
                     });

    map->facts.base_speed = static_cast<float>(options.speed);
    map->facts.period = static_cast<float>(plan.period * plan.reference_length / options.speed);
    map->facts.density = static_cast<float>(options.density);
    map->facts.viscosity = static_cast<float>(options.viscosity);
    map->facts.reference_length = static_cast<float>(plan.reference_length);
    map->facts.reynolds = static_cast<float>(options.speed * plan.reference_length / options.viscosity);
    map->facts.reynolds_solved = std::min(map->facts.reynolds, static_cast<float>(reynolds_solved));
    fill_fluctuations(*map, fluctuations, quantisation_budget);
    map->provenance = provenance(options, plan, report);
    map->complete();
    report.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    return map;
}

}  // namespace frm::bake
