// From a mesh and options to what has to be computed.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "bake/bake.h"
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

}  // namespace

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

    plan.mesh_hash = mesh_hash(options.mesh);
    const Surface surface = load_surface(options.mesh, plan.notes, options.scale);
    const SurfaceProperties shape = measure(surface);
    plan.surface = tessellate(surface, length(shape.high - shape.low) / longest_edges, most_triangles).surface;
    plan.regions = split_regions(plan.surface, sources);
    plan.patches = plan.regions;

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
        Task task{"direction " + std::to_string(d), c, plan_flow(plan.surface, c)};
        const std::string& warning = task.cost.warning;
        if (!warning.empty() && std::find(plan.notes.begin(), plan.notes.end(), warning) == plan.notes.end())
            plan.notes.push_back(warning);
        plan.tasks.push_back(std::move(task));
    }
    return plan;
}

bool extend_plan(BakePlan&, const std::vector<TaskResult>&) { return false; }

}  // namespace frm::bake
