// frm bake.
#include "bake/bake.h"

#include <chrono>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/file.h"
#include "cli/problem_file.h"
#include "cli/progress.h"
#include "core/map/codec.h"

namespace frm::cli {
namespace {

struct Options {
    bake::BakeOptions bake;
    std::string out, quality = "standard";
    bool json = false;
};

bake::Quality quality_of(const std::string& word) {
    return word == "draft" ? bake::Quality::draft : word == "high" ? bake::Quality::high : bake::Quality::standard;
}

void print_plan(const bake::BakePlan& plan) {
    for (const std::string& note : plan.notes) std::fprintf(stderr, "note: %s\n", note.c_str());
    std::uint64_t bytes = 0;
    double updates = 0;
    for (const bake::Task& task : plan.tasks) {
        bytes = std::max(bytes, task.cost.bytes);
        updates += task.cost.updates;
    }
    std::fprintf(
        stderr,
        "%u directions, %u sources, %zu triangles; %.3g cell updates, %.0f MB of memory for each that runs at a time\n",
        plan.directions.count(), plan.regions.count, plan.surface.triangles.size(), updates,
        static_cast<double>(bytes) / 1e6);
}

void run(Options& o) {
    o.bake.quality = quality_of(o.quality);
    require_distinct({o.out}, {o.bake.mesh});
    require_writable(o.out);
    bake::BakePlan plan = load_or_show(o.bake.mesh, o.out, [&] { return bake::plan_bake(o.bake); });
    print_plan(plan);
    bake::BakeReport report;
    std::unique_ptr<Map> map;
    const auto begin = std::chrono::steady_clock::now();
    {
        ProgressBar bar("bake");
        map = bake::bake(
            plan, [&](double share, const std::string& note) { return bar.update(share, note); }, report);
    }
    const std::vector<std::uint8_t> file = encode_map(*map);
    write_file(o.out, file.data(), file.size());

    double worst = 0;
    for (const bake::DirectionReport& d : report.directions) worst = std::max(worst, d.uncertainty);
    if (worst > 0.1)
        std::fprintf(
            stderr,
            "note: the mean drag of a direction is uncertain by %.0f %%: take a higher --quality or --resolution\n",
            100 * worst);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    double updates = 0;
    for (const bake::Task& task : plan.tasks) updates += task.cost.updates / seconds / 1e6;
    if (o.json) {
        nlohmann::ordered_json j{{"file", o.out},
                                 {"file_bytes", file.size()},
                                 {"directions", map->directions.count()},
                                 {"sources", map->source_count()},
                                 {"samples", map->samples},
                                 {"reynolds", map->facts.reynolds},
                                 {"reynolds_solved", map->facts.reynolds_solved},
                                 {"uncertainty", worst},
                                 {"quantisation_error", map->facts.quantisation_error},
                                 {"mlups", updates},
                                 {"seconds", seconds}};
        std::printf("%s\n", j.dump(2).c_str());
    } else {
        std::printf(
            "%s: %.1f kB, %u directions, %u sources, %u samples, in %.1f s (%.0f million cell updates a second)\n",
            o.out.c_str(), static_cast<double>(file.size()) / 1e3, map->directions.count(), map->source_count(),
            map->samples, seconds, updates);
        std::printf(
            "mean drag is uncertain by %.1f %% (worst direction); fluctuations are stored to %.2g of the peak force\n",
            100 * worst, static_cast<double>(map->facts.quantisation_error));
    }
}

}  // namespace

void add_bake(CLI::App& app) {
    auto options = std::make_shared<Options>();
    Options& o = *options;
    CLI::App* command = app.add_subcommand(
        "bake", "Solves the flow around an object from many directions and stores the forces as a map.");
    command->footer(
        "The mesh is a closed glTF surface in metres; its frame is the map's.\n"
        "  frm bake paddle.glb -o paddle.frm --quality draft");
    command->add_option("MESH", o.bake.mesh, "a .glb or .gltf file")->required()->check(not_empty())->type_name("");
    command->add_option("-o,--out", o.out, "the .frm file to write; it appears whole or not at all")
        ->required()
        ->check(not_empty())
        ->type_name("FILE");
    command
        ->add_option("--quality", o.quality, "how fine all that follows is; draft takes a minute (default: standard)")
        ->check(one_of({"draft", "standard", "high"}))
        ->type_name("draft|standard|high");
    command->add_option("--speed", o.bake.speed, "base speed of the stream, m/s")
        ->check(stream_speed_range())
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--density", o.bake.density, "of the fluid, kg/m^3")
        ->check(density_range())
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--viscosity", o.bake.viscosity, "kinematic, m^2/s")
        ->check(viscosity_range())
        ->type_name("N")
        ->capture_default_str();
    command
        ->add_option("--directions", o.bake.directions, "of the stream: 6, 18, 38, 66, 102, ... (default: by quality)")
        ->check(whole_within(6, 1026))
        ->type_name("N");
    command->add_option("--sources", o.bake.sources, "haptic sources, 1 to 4096 (default: by quality)")
        ->check(whole_within(1, 4096))
        ->type_name("N");
    command
        ->add_option("--resolution", o.bake.resolution, "grid cells across the object, 4 to 512 (default: by quality)")
        ->check(number_within(4, 512))
        ->type_name("N");
    command->add_option("--triangles", o.bake.triangles, "sample triangles of the surface at most (default: 2000)")
        ->check(whole_within(4, 2097152))
        ->type_name("N");
    command->add_option("--threads", o.bake.threads, "0: all cores. The map does not depend on it")
        ->check(whole_within(0, 256))
        ->type_name("N")
        ->capture_default_str();
    command->add_flag("--json", o.json, "JSON on standard output");
    command->callback([options] { run(*options); });
}

}  // namespace frm::cli
