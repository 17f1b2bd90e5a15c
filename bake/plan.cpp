// From a mesh and options to what has to be computed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "bake/bake.h"
#include "bake/directions/known.h"
#include "bake/directions/transfer.h"
#include "bake/mesh/gltf.h"
#include "bake/mesh/repair.h"
#include "bake/regions/choose.h"
#include "bake/regions/regions.h"
#include "bake/regions/tessellate.h"
#include "bake/series/periodic.h"
#include "bake/spin_table.h"
#include "bake/symmetry/symmetry.h"
#include "bake/tasks/forces.h"
#include "core/math/hash.h"

namespace frm::bake {
namespace {

struct Preset {
    /// Of the first directions, and of the map's fluctuations: the largest that symmetry makes no more flows of than
    /// `flows`, between these.
    std::uint32_t least_frequency, most_frequency, flows;
    double cells, start_up, period;  ///< cells and lengths in reference lengths
    double region_error;             ///< see choose_regions()
    DirectionErrors budget;          ///< shares of the largest force
    std::uint32_t mean_frequency;    ///< of the directions that the map stores means for
    double record_flows;             ///< where there are fewer flows than that at first, their records are longer
};

// The wake of a flow that has just begun swings two to seven times as strongly as later and pushes up to 14 % harder; it
// takes some twenty lengths to fade (docs/bake.md, "The start").
Preset preset(Quality quality) {
    switch (quality) {
        case Quality::draft:
            return {2, 4, 18, 12, 18, 8, kDraftRegionError, {0, 0}, 6, 0};
        case Quality::high:
            return {4, 4, 0, 36, 20, 40, kHighRegionError, {0.03, 0.08}, 10, 66};
        default:
            return {3, 3, 0, 24, 20, 16, kStandardRegionError, {0.06, 0.15}, 8, 38};
    }
}

constexpr double most_record = 2.5;         ///< times as long as a period and the overlap
constexpr double harmonics_per_length = 2;  ///< kept: shedding is at 0.1 to 0.2 a length, so ten of its harmonics
constexpr double most_more = 1.5;           ///< directions added at most, as a share of the first ones
constexpr std::uint32_t round_size = 4;     ///< directions added at a time
// Carried over to other regions by a symmetry, a flow's forces must be known on parts that are smaller than these.
constexpr std::uint32_t patches_per_region = 4, triangles_per_patch = 5, most_patches = 1000;

std::string text_of(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%.9g", v);
    return text;
}

std::string mesh_hash(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    return hash_text(fnv1a(bytes.data(), bytes.size()));
}

void require(bool good, const std::string& text) {
    if (!good) throw BakeError(text);
}

/// What flows are recorded on: of a finite group as many patches as carry exactly; of a continuous one, or where these
/// are too many to be worth their memory, patches some times smaller than the regions.
void choose_patches(BakePlan& plan) {
    const Symmetry& symmetry = plan.symmetry;
    if (symmetry.kind == SymmetryKind::finite) {
        const Landing landing(plan.surface, symmetry.tolerance);
        plan.patches = patches_for(plan.surface, plan.regions, symmetry.elements, symmetry.centre, landing);
        if (plan.patches.count <= std::max(most_patches, plan.regions.count)) return;
    }
    const auto triangles = static_cast<std::uint32_t>(plan.surface.triangles.size());
    const std::uint32_t wanted =
        std::min({patches_per_region * plan.regions.count, triangles / triangles_per_patch, most_patches});
    plan.patches = wanted > plan.regions.count ? split_regions(plan.surface, wanted) : plan.regions;
}

void add_task(BakePlan& plan, TaskKind kind, std::string name, const FlowCase& flow) {
    Task task{std::move(name), kind, flow, plan_flow(plan.surface, flow)};
    const std::string& warning = task.cost.warning;
    if (!warning.empty() && std::find(plan.notes.begin(), plan.notes.end(), warning) == plan.notes.end())
        plan.notes.push_back(warning);
    plan.tasks.push_back(std::move(task));
}

FlowCase base_case(const BakePlan& plan) {
    FlowCase c;
    c.density = plan.options.density;
    c.viscosity = plan.options.viscosity;
    c.resolution = plan.options.resolution > 0 ? plan.options.resolution : preset(plan.options.quality).cells;
    c.reference_length = plan.reference_length;
    c.start_up = plan.start_up;
    c.duration = plan.record;
    c.grid_error = true;  // the start is then run on half the resolution
    c.pictures = true;
    return c;
}

void add_stream(BakePlan& plan, const Vec3d& direction, double speed) {
    FlowCase c = base_case(plan);
    c.direction = direction;
    c.speed = speed;
    std::string name = "direction";
    for (int i = 0; i < 3; ++i) {
        char text[16];
        std::snprintf(text, sizeof text, " %.2f", direction[i] + 0.0);
        name += text;
    }
    if (speed != plan.options.speed) name += " at " + text_of(speed) + " m/s";
    try {
        add_task(plan, TaskKind::stream, std::move(name), c);
    } catch (const BakeError& error) {
        if (speed == plan.options.speed) throw;
        throw BakeError("--speeds " + text_of(speed) + ": " + error.what());
    }
}

/// Turns so fast that the fastest point of all moves at the base speed. Cells and lengths travelled are counted by what
/// turns: a paddle about its long axis is as wide as its blade, and cells for the whole length of it would be too few.
void add_spins(BakePlan& plan, const SurfaceProperties& shape) {
    const auto farthest = [&](const auto& distance) {
        double radius = 0;
        for (const Vec3d& v : plan.surface.vertices) radius = std::max(radius, length(distance(v - shape.centroid)));
        return radius;
    };
    plan.spin_rate = plan.options.speed / farthest([](const Vec3d& arm) { return arm; });
    for (const Vec3d& axis : distinct_spins(plan.symmetry)) {
        FlowCase c = base_case(plan);
        c.speed = 0;
        c.spin = axis * plan.spin_rate;
        c.spin_centre = shape.centroid;
        // A turning body stays in its own wake: after four lengths that is still the coarse cells' (docs/bake.md, "Spin").
        c.grid_error = false;
        const double across = 2 * farthest([&](const Vec3d& arm) { return cross(axis, arm); });
        c.reference_length = std::min(c.reference_length, across);
        const int along = axis.x != 0 ? 0 : axis.y != 0 ? 1 : 2;
        add_task(plan, TaskKind::spin, std::string("spin ") + (axis[along] < 0 ? "-" : "+") + "xyz"[along], c);
    }
}

}  // namespace

const char* name_of(Quality quality) {
    return quality == Quality::draft ? "draft" : quality == Quality::high ? "high" : "standard";
}

Quality quality_of(const std::string& name) {
    for (const Quality quality : kQualities)
        if (name == name_of(quality)) return quality;
    return Quality::standard;
}

double region_error_of(Quality quality) { return preset(quality).region_error; }

std::uint32_t frequency_of(std::uint32_t directions) {
    for (std::uint32_t n = 1; n <= 16; ++n)
        if (4 * n * n + 2 == directions) return n;
    return 0;
}

Surface load_surface(const std::string& path, std::vector<std::string>& notes, double scale) {
    Repaired repaired = repair(load_gltf(path, scale), path);
    notes.insert(notes.end(), repaired.notes.begin(), repaired.notes.end());
    return std::move(repaired.surface);
}

BakePlan plan_bake(const BakeOptions& options) {
    const Preset p = preset(options.quality);
    BakePlan plan;
    plan.options = options;
    std::uint32_t frequency = options.directions ? frequency_of(options.directions) : p.least_frequency;
    require(frequency > 0, "--directions " + std::to_string(options.directions) +
                               ": a direction set has 4 n^2 + 2 directions: 6, 18, 38, 66, 102, "
                               "146, ... up to 1026");
    require(options.sources <= Map::max_sources, "--sources " + std::to_string(options.sources) + ": at most 4096");
    const std::uint32_t most_triangles = options.triangles ? options.triangles : 2000;
    require(most_triangles <= Map::max_triangles, "--triangles: at most 2097152");
    plan.speeds = options.speeds;
    plan.speeds.push_back(options.speed);
    std::sort(plan.speeds.begin(), plan.speeds.end());
    plan.speeds.erase(std::unique(plan.speeds.begin(), plan.speeds.end()), plan.speeds.end());
    require(plan.speeds.size() <= Map::max_speeds,
            "--speeds: a map holds at most 16, the base speed among them, not " + std::to_string(plan.speeds.size()));
    // A map has them in single precision, and would be refused when all is solved.
    for (std::size_t k = 1; k < plan.speeds.size(); ++k)
        require(static_cast<float>(plan.speeds[k - 1]) < static_cast<float>(plan.speeds[k]),
                "--speeds: two are too near to each other to be told apart, " + text_of(plan.speeds[k]) + " m/s");

    plan.mesh_hash = mesh_hash(options.mesh);
    const Surface surface = load_surface(options.mesh, plan.notes, options.scale);
    const SurfaceProperties shape = measure(surface);
    plan.surface = sample_triangles(surface, most_triangles);
    plan.regions = options.sources ? split_regions(plan.surface, options.sources)
                                   : choose_regions(plan.surface, {p.region_error}).regions;
    plan.symmetry.centre = shape.centroid;  // torques are fitted about it, with symmetry or without
    if (options.symmetry) plan.symmetry = find_symmetry(surface);
    choose_patches(plan);

    std::vector<Vec3d> first = distinct_directions(plan.symmetry, frequency);
    while (!options.directions && frequency < p.most_frequency) {
        std::vector<Vec3d> more = distinct_directions(plan.symmetry, frequency + 1);
        if (more.size() > p.flows) break;
        first = std::move(more);
        ++frequency;
    }
    plan.directions = DirectionSet(std::max(frequency, p.mean_frequency));
    plan.fluctuation_directions = DirectionSet(frequency);
    double area = 0;
    const DirectionSet all_round(3);
    for (std::uint32_t d = 0; d < all_round.count(); ++d) area += projected_area(surface, all_round.direction(d));
    plan.reference_length = std::sqrt(area / all_round.count());
    plan.start_up = p.start_up;
    plan.period = p.period;
    plan.overlap = overlap_share * p.period;
    plan.record =
        (p.period + plan.overlap) * std::clamp(p.record_flows / static_cast<double>(first.size()), 1.0, most_record);
    plan.harmonics = static_cast<std::uint32_t>(harmonics_per_length * plan.period);
    plan.samples = good_length(2 * plan.harmonics + 2);

    const double sources = plan.regions.count;
    const double means = sources * plan.directions.count() * static_cast<double>(plan.speeds.size()) * Map::components;
    const double fluctuations = sources * plan.fluctuation_directions.count() * plan.samples * Map::components;
    require(means <= Map::max_means && fluctuations <= Map::max_fluctuations,
            "--sources, --directions and --speeds together are more than a map holds: " +
                std::to_string(plan.regions.count) + " sources, " +
                std::to_string(plan.fluctuation_directions.count()) + " directions, " +
                std::to_string(plan.speeds.size()) + " speeds");

    plan.spacing = spacing_of(frequency);
    if (!options.directions) plan.budget = p.budget;
    plan.most_directions = static_cast<std::uint32_t>(std::ceil((1 + most_more) * static_cast<double>(first.size())));
    for (std::size_t k = 0; k < plan.speeds.size(); ++k)
        for (const Vec3d& e : first) add_stream(plan, e, plan.speeds[k]);
    if (options.spin) add_spins(plan, shape);
    return plan;
}

std::size_t most_tasks(const BakePlan& plan) {
    if (!(plan.budget.rms > 0)) return plan.tasks.size();
    std::size_t base = 0;
    for (const Task& task : plan.tasks) base += task.is_stream(plan.options.speed);
    return plan.tasks.size() + std::max<std::size_t>(plan.most_directions, base) - base;
}

bool extend_plan(BakePlan& plan, const std::vector<TaskResult>& results) {
    if (!(plan.budget.rms > 0)) return false;
    std::vector<SolvedDirection> solved;
    for (std::size_t k = 0; k < results.size(); ++k) {
        const Task& task = plan.tasks[k];
        if (!task.is_stream(plan.options.speed)) continue;
        solved.push_back(solved_direction(task.flow.direction, means_of(results[k]), plan.symmetry.centre));
    }
    if (solved.size() >= plan.most_directions) return false;
    const ShapePressure shape(plan.surface, plan.regions, plan.symmetry.centre);
    const KnownForces known(plan.symmetry, solved, plan.reference_length, plan.spacing, &shape);
    const DirectionErrors errors = known.errors();
    if (errors.rms <= plan.budget.rms && errors.worst <= plan.budget.worst) return false;
    const std::vector<Vec3d> more = known.next(std::min<std::size_t>(round_size, plan.most_directions - solved.size()));
    for (const Vec3d& e : more) add_stream(plan, e, plan.options.speed);
    return !more.empty();
}

}  // namespace frm::bake
