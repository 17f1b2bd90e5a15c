// From the flows' forces to the map.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "bake/bake.h"
#include "bake/directions/fluctuations.h"
#include "bake/directions/region_forces.h"
#include "bake/directions/torque.h"
#include "bake/map/fill.h"
#include "bake/potential/added_mass.h"
#include "bake/spin_table.h"

namespace frm::bake {
namespace {

/// The streams of one speed and what they found.
struct Streams {
    std::vector<const TaskResult*> results;
    std::vector<FlowMeans> means;
    std::vector<SolvedDirection> solved;
    std::vector<std::size_t> tasks;
};

Streams streams_at(const BakePlan& plan, const std::vector<TaskResult>& results, const std::vector<FlowMeans>& means,
                   double speed) {
    Streams out;
    for (std::size_t k = 0; k < results.size(); ++k) {
        if (!plan.tasks[k].is_stream(speed)) continue;
        out.results.push_back(&results[k]);
        out.means.push_back(means[k]);
        out.solved.push_back(solved_direction(plan.tasks[k].flow.direction, means[k], plan.symmetry.centre));
        out.tasks.push_back(k);
    }
    return out;
}

void add_means(Tables& tables, const BakePlan& plan, const RegionForces& forces, const Map& map) {
    for (std::uint32_t d = 0; d < plan.directions.count(); ++d) {
        const Vec3d e = plan.directions.direction(d);
        std::vector<PatchForce> mean = forces.mean(e);
        restore_torque(mean, map.sources, plan.symmetry.centre, forces.known().torque(e));
        for (const PatchForce& f : mean) tables.mean.push_back({Vec3f(f.pressure), Vec3f(f.friction)});
    }
}

PeriodicSpec spec_of(const BakePlan& plan, const Streams& streams) {
    PeriodicSpec spec;
    // The solver's interval is a whole number of its steps, so that a period is a whole number of intervals only
    // nearly.
    const double period_time = plan.period * plan.reference_length / plan.options.speed;
    const TaskResult& first = *streams.results.front();
    spec.period = std::min(2 * static_cast<std::uint32_t>(std::lround(0.5 * period_time / first.interval)),
                           first.samples / 2 * 2);
    spec.samples = plan.samples;
    spec.harmonics = plan.harmonics;
    double largest = 0;
    for (const FlowMeans& means : streams.means) largest = std::max(largest, length(means.force));
    spec.threshold = plan.options.threshold * largest / std::sqrt(static_cast<double>(plan.regions.count));
    return spec;
}

BakeReport::Flow describe(const Task& task, const TaskResult& result, const FlowMeans& means) {
    BakeReport::Flow out;
    out.name = task.name;
    out.uncertainty = result.uncertainty.total();
    const FlowCase& flow = task.flow;
    if (task.kind == TaskKind::spin) {
        out.speed = length(flow.spin);
        out.direction = flow.spin / out.speed;
        return out;
    }
    out.direction = flow.direction;
    out.speed = flow.speed;
    const double unit = 0.5 * flow.density * flow.speed * flow.speed * result.plan.projected_area;
    out.drag_coefficient = dot(means.force, flow.direction) / unit;
    return out;
}

/// Where the streams of one speed are known, and how well from each other.
void describe(BakeReport& report, const std::vector<std::size_t>& tasks, const KnownForces& known) {
    for (std::size_t i = 0; i < tasks.size(); ++i) {
        BakeReport::Flow& flow = report.flows[tasks[i]];
        for (const Image& image : known.images_of(i)) flow.images.push_back(image.direction);
        if (tasks.size() > 1) flow.left_out = known.error_of(i);
    }
}

// Wall time, thread count and machine are left out: the same mesh and options give the same file.
std::string provenance(const BakePlan& plan, const std::vector<TaskResult>& results, const BakeReport& report) {
    nlohmann::ordered_json j;
    const BakeOptions& options = plan.options;
    j["mesh"] = options.mesh.substr(options.mesh.find_last_of('/') + 1);
    j["mesh_hash"] = plan.mesh_hash;
    if (options.scale != 1) j["scale"] = options.scale;
    j["quality"] = name_of(options.quality);
    j["solver"] =
        "lattice Boltzmann D3Q19, regularised, Smagorinsky, interpolated bounce-back, nested blocks (docs/flow.md)";
    j["resolution"] = plan.tasks.front().flow.resolution;
    j["start_up_lengths"] = plan.start_up;
    j["period_lengths"] = plan.period;
    j["record_lengths"] = plan.record;
    j["harmonics"] = plan.harmonics;
    j["symmetry"] = {{"kind", name_of(plan.symmetry.kind)}, {"isometries", plan.symmetry.elements.size()}};
    j["notes"] = plan.notes;
    for (std::size_t k = 0; k < results.size(); ++k) {
        const BakeReport::Flow& flow = report.flows[k];
        const FlowPlan& cost = results[k].plan;
        const bool spin = plan.tasks[k].kind == TaskKind::spin;
        j[spin ? "spins" : "directions"].push_back(
            {{"direction", {flow.direction.x, flow.direction.y, flow.direction.z}},
             {spin ? "rate" : "speed", flow.speed},
             {"drag_coefficient", flow.drag_coefficient},
             {"uncertainty", flow.uncertainty},
             {"projected_area", cost.projected_area},
             {"reynolds_solved", cost.reynolds_solved},
             {"blockage", cost.blockage},
             {"cells", cost.cells},
             {"steps", cost.steps}});
    }
    return j.dump();
}

}  // namespace

std::unique_ptr<Map> make_map(const BakePlan& plan, const std::vector<TaskResult>& results, BakeReport& report,
                              Tables* raw) {
    const BakeOptions& options = plan.options;
    auto map = std::make_unique<Map>();
    fill_surface(*map, plan.surface, plan.regions);
    map->directions = plan.directions;
    map->fluctuation_directions = plan.fluctuation_directions;
    map->samples = plan.samples;
    for (const double speed : plan.speeds) map->speeds.push_back(static_cast<float>(speed));

    MapFacts& facts = map->facts;
    const double reynolds = options.speed * plan.reference_length / options.viscosity;
    double solved = reynolds, largest = 0;
    report = {};
    std::vector<FlowMeans> means;
    for (std::size_t k = 0; k < results.size(); ++k) {
        means.push_back(means_of(results[k]));
        report.flows.push_back(describe(plan.tasks[k], results[k], means[k]));
        if (!plan.tasks[k].is_stream(options.speed)) continue;
        solved = std::min(solved, results[k].plan.reynolds_solved);
        const double drag = std::fabs(dot(means[k].force, plan.tasks[k].flow.direction));
        report.uncertainty = std::max(report.uncertainty, report.flows[k].uncertainty * drag);
        largest = std::max(largest, length(means[k].force));
    }
    if (largest > 0) report.uncertainty /= largest;

    const Landing landing(plan.surface, plan.symmetry.tolerance);
    Transfers transfers({plan.surface, plan.patches, plan.regions, plan.symmetry.centre, landing});
    Tables tables;
    for (const double speed : plan.speeds) {
        const Streams streams = streams_at(plan, results, means, speed);
        const RegionForces forces(transfers, plan.symmetry, streams.means, streams.solved, plan.reference_length,
                                  plan.spacing);
        add_means(tables, plan, forces, *map);
        describe(report, streams.tasks, forces.known());
        if (speed != options.speed) continue;
        report.direction_errors = forces.known().errors();
        tables.fluctuation = fluctuations(forces, streams.results, plan.regions.count, plan.fluctuation_directions,
                                          spec_of(plan, streams));
    }

    facts.base_speed = static_cast<float>(options.speed);
    facts.period = static_cast<float>(plan.period * plan.reference_length / options.speed);
    facts.density = static_cast<float>(options.density);
    facts.viscosity = static_cast<float>(options.viscosity);
    facts.reference_length = static_cast<float>(plan.reference_length);
    facts.reynolds = static_cast<float>(reynolds);
    facts.reynolds_solved = std::min(facts.reynolds, static_cast<float>(solved));
    facts.direction_error_rms = static_cast<float>(report.direction_errors.rms);
    facts.direction_error_worst = static_cast<float>(report.direction_errors.worst);
    facts.uncertainty = static_cast<float>(report.uncertainty);
    if (options.added_mass) {
        const AddedMass added = added_mass(plan.surface, {options.density});
        map->added_mass = added.matrix;
        report.added_mass_error = added.error;
        map->has_added_mass = true;
    }
    fill_tables(*map, tables, kRoundingBudget);
    if (plan.spin_rate > 0) {
        map->complete();  // the local streams are looked up in it
        fill_spin(*map, plan, means, transfers);
    }
    map->provenance = provenance(plan, results, report);
    map->complete();
    if (raw) *raw = std::move(tables);
    return map;
}

}  // namespace frm::bake
