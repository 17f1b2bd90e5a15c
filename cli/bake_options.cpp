#include "cli/bake_options.h"

#include <algorithm>
#include <cstdio>

#include "cli/mesh_size.h"
#include "cli/problem_file.h"

namespace frm::cli {

Cost cost_of(const bake::BakePlan& plan) {
    Cost cost;
    for (const bake::Task& task : plan.tasks) {
        cost.updates += task.cost.updates;
        cost.bytes = std::max(cost.bytes, task.cost.bytes);
    }
    return cost;
}

void complete(const CLI::App& command, BakeArguments& a) {
    a.bake.quality = bake::quality_of(a.quality);
    a.has_scale = command.count("--scale") > 0;
}

void settle_unit(BakeArguments& a) {
    if (!a.has_scale && !a.yes) settle_size(a.bake.mesh, a.bake.scale);
}

bake::BakePlan make_plan(const BakeArguments& a, const std::string& out) {
    return load_or_show(a.bake.mesh, out, [&] { return bake::plan_bake(a.bake); });
}

void print_plan(const bake::BakePlan& plan) {
    for (const std::string& note : plan.notes) std::fprintf(stderr, "note: %s\n", note.c_str());
    const Cost cost = cost_of(plan);
    std::fprintf(stderr,
                 "symmetry: %s\n"
                 "%u sources, %zu triangles; %zu flows%s, %.3g cell updates, %.0f MB of memory for each that runs at a "
                 "time\n",
                 bake::describe(plan.symmetry).c_str(), plan.regions.count, plan.surface.triangles.size(),
                 plan.tasks.size(), plan.budget.rms > 0 ? " or more" : "", cost.updates,
                 static_cast<double>(cost.bytes) / 1e6);
}

void add_bake_arguments(CLI::App& command, BakeArguments& a, bool required) {
    command.add_option("MESH", a.bake.mesh, "a .glb or .gltf file")
        ->required(required)
        ->check(not_empty())
        ->type_name("");
    command
        .add_option("--quality", a.quality, "how fine all that follows is; draft takes a minute (default: standard)")
        ->check(one_of({"draft", "standard", "high"}))
        ->type_name("draft|standard|high");
    add_scale(command, a.bake.scale);
    command.add_flag("--yes", a.yes, "the mesh's size is right as it is: do not ask where it is not plausible");
    command.add_option("--speed", a.bake.speed, "base speed of the stream, m/s")
        ->check(stream_speed_range())
        ->type_name("N")
        ->capture_default_str();
    command
        .add_option("--speeds", a.bake.speeds,
                    "further ones, m/s, by commas: the map then follows the Reynolds number (docs/bake.md)")
        ->delimiter(',')
        ->allow_extra_args(false)  // or the mesh would be one of them
        ->check(stream_speed_range())
        ->type_name("N,N,...");
    command.add_flag("--spin", a.bake.spin, "solve turns about three axes in still water too");
    command.add_option("--density", a.bake.density, "of the fluid, kg/m^3")
        ->check(density_range())
        ->type_name("N")
        ->capture_default_str();
    command.add_option("--viscosity", a.bake.viscosity, "kinematic, m^2/s")
        ->check(viscosity_range())
        ->type_name("N")
        ->capture_default_str();
    command
        .add_option("--directions", a.bake.directions,
                    "exactly so many, before symmetry: 6, 18, 38, 66, 102, ... (default: by quality,\n"
                    "and more where the force bends)")
        ->check(whole_within(6, 1026))
        ->type_name("N");
    command.add_option("--sources", a.bake.sources, "haptic sources, 1 to 4096 (default: by their error)")
        ->check(whole_within(1, 4096))
        ->type_name("N");
    command
        .add_option("--resolution", a.bake.resolution, "grid cells across the object, 4 to 512 (default: by quality)")
        ->check(number_within(4, 512))
        ->type_name("N");
    command.add_flag("--no-symmetry{false}", a.bake.symmetry, "solve every direction, whatever symmetry the mesh has");
    command.add_flag("--no-added-mass{false}", a.bake.added_mass, "leave the added mass out of the map");
    command
        .add_option("--threshold", a.bake.threshold,
                    "drop harmonics of the fluctuation below this share of the largest mean force")
        ->check(number_within(0, 1))
        ->type_name("N")
        ->capture_default_str();
    command.add_option("--triangles", a.bake.triangles, "sample triangles of the surface at most (default: 2000)")
        ->check(whole_within(4, 2097152))
        ->type_name("N");
}

}  // namespace frm::cli
