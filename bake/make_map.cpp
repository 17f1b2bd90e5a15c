// From the flows' forces to the map.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bake/bake.h"
#include "bake/map/fill.h"
#include "bake/series/periodic.h"

namespace frm::bake {
namespace {

constexpr double amplitude_threshold = 2e-4;  ///< of the mean force on the whole object: harmonics below are dropped
constexpr double quantisation_budget = 2e-3;  ///< of the peak force

/// One direction's series, [samples][regions][3], made periodic source by source and component by component; the means
/// go to the tables' place for this direction.
Fluctuation add_direction(Tables& tables, std::size_t direction, const FlowSeries& flow, const BakePlan& plan, double speed) {
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
        SourceForce& mean = tables.mean[direction * regions + l];
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
    return {flow_case.direction, drag / unit, flow.uncertainty.total()};
}

// Wall time, thread count and machine are left out: the same mesh and options give the same file.
std::string provenance(const BakePlan& plan, const std::vector<TaskResult>& results, const BakeReport& report) {
    const BakeOptions& options = plan.options;
    nlohmann::ordered_json j;
    j["mesh"] = options.mesh.substr(options.mesh.find_last_of('/') + 1);
    j["mesh_hash"] = plan.mesh_hash;
    if (options.scale != 1) j["scale"] = options.scale;
    j["quality"] = options.quality == Quality::draft ? "draft" : options.quality == Quality::high ? "high" : "standard";
    j["solver"] = "lattice Boltzmann D3Q19, regularised, Smagorinsky, interpolated bounce-back, nested blocks (docs/flow.md)";
    j["resolution"] = plan.tasks.front().flow.resolution;
    j["start_up_lengths"] = plan.start_up;
    j["period_lengths"] = plan.period;
    j["harmonics"] = plan.harmonics;
    j["notes"] = plan.notes;
    for (std::size_t d = 0; d < report.directions.size(); ++d) {
        const DirectionReport& r = report.directions[d];
        const FlowPlan& flow = results[d].plan;
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

std::unique_ptr<Map> make_map(const BakePlan& plan, const std::vector<TaskResult>& results, BakeReport& report) {
    const BakeOptions& options = plan.options;
    auto map = std::make_unique<Map>();
    fill_surface(*map, plan.surface, plan.regions);
    map->directions = map->fluctuation_directions = plan.directions;
    map->samples = plan.samples;

    Tables tables;
    tables.mean.resize(results.size() * plan.regions.count);
    double reynolds_solved = options.speed * plan.reference_length / options.viscosity;
    for (std::size_t d = 0; d < results.size(); ++d) {
        tables.fluctuation.push_back(add_direction(tables, d, results[d], plan, options.speed));
        report.directions.push_back(describe(results[d], plan.tasks[d].flow));
        reynolds_solved = std::min(reynolds_solved, results[d].plan.reynolds_solved);
    }

    map->facts.base_speed = static_cast<float>(options.speed);
    map->facts.period = static_cast<float>(plan.period * plan.reference_length / options.speed);
    map->facts.density = static_cast<float>(options.density);
    map->facts.viscosity = static_cast<float>(options.viscosity);
    map->facts.reference_length = static_cast<float>(plan.reference_length);
    map->facts.reynolds = static_cast<float>(options.speed * plan.reference_length / options.viscosity);
    map->facts.reynolds_solved = std::min(map->facts.reynolds, static_cast<float>(reynolds_solved));
    map->speeds.assign(1, map->facts.base_speed);
    fill_tables(*map, tables, quantisation_budget);
    map->provenance = provenance(plan, results, report);
    map->complete();
    return map;
}

}  // namespace frm::bake
