// frm mesh: what the bake makes of a mesh, without solving anything.
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include "bake/bake.h"
#include "bake/mesh/glb_writer.h"
#include "bake/mesh/gltf.h"
#include "bake/mesh/repair.h"
#include "bake/mesh/thickness.h"
#include "bake/potential/added_mass.h"
#include "bake/regions/choose.h"
#include "bake/regions/tessellate.h"
#include "bake/symmetry/symmetry.h"
#include "cli/command.h"
#include "cli/file.h"
#include "cli/mesh_size.h"
#include "cli/problem_file.h"

namespace frm::cli {
namespace {

struct Options {
    std::string mesh, out;
    bool json = false, regions = false, added_mass = false;
    double density = 1000, scale = 1;
};

struct Choice {
    const char* quality;
    double budget;
    bake::ChosenRegions chosen;
};

/// What a bake of each quality would choose, on the triangles that it works on.
std::vector<Choice> choose(const bake::Surface& surface) {
    std::vector<Choice> result;
    const bake::Surface sampled = bake::sample_triangles(surface);
    for (const bake::Quality quality : bake::kQualities) {
        const double error = bake::region_error_of(quality);
        result.push_back({bake::name_of(quality), error, bake::choose_regions(sampled, {error})});
    }
    return result;
}

nlohmann::ordered_json vec(const Vec3d& v) { return {v.x, v.y, v.z}; }

void print_json(const Options& o, const bake::Repaired& r, const bake::SurfaceProperties& shape,
                const bake::Thickness& thickness, const bake::Symmetry& symmetry, const std::vector<Choice>& choices,
                const bake::AddedMass* mass) {
    nlohmann::ordered_json j;
    j["file"] = o.mesh;
    j["triangles"] = r.surface.triangles.size();
    j["vertices"] = r.surface.vertices.size();
    j["shells"] = r.shells;
    j["low"] = vec(shape.low);
    j["high"] = vec(shape.high);
    j["size"] = vec(shape.high - shape.low);
    j["area"] = shape.area;
    j["volume"] = shape.volume;
    j["centroid"] = vec(shape.centroid);
    j["thinnest"] = thickness.thinnest;
    j["thinnest_at"] = vec(thickness.thinnest_at);
    j["median_thickness"] = thickness.median;
    auto& s = j["symmetry"];
    s["kind"] = bake::name_of(symmetry.kind);
    if (symmetry.kind == bake::SymmetryKind::finite) {
        s["elements"] = nlohmann::ordered_json::array();
        for (const bake::Matrix3& g : symmetry.elements)
            s["elements"].push_back({vec(g.row[0]), vec(g.row[1]), vec(g.row[2])});
    } else if (symmetry.kind != bake::SymmetryKind::spherical) {
        s["axis"] = vec(symmetry.axis);
    }
    s["tolerance"] = symmetry.tolerance;
    s["worst"] = symmetry.worst;
    if (o.regions) j["regions"] = nlohmann::ordered_json::array();
    for (const Choice& c : choices) {
        const bake::RegionErrors& e = c.chosen.errors;
        j["regions"].push_back({{"quality", c.quality},
                                {"budget", c.budget},
                                {"count", c.chosen.regions.count},
                                {"within_budget", c.chosen.reached},
                                {"error", e.whole},
                                {"wet_ratio", e.wet_ratio},
                                {"velocity", e.velocity},
                                {"arm", e.arm}});
    }
    j["cuts_within"] = r.cuts.within;
    j["cuts_between"] = r.cuts.between;
    j["notes"] = r.notes;
    if (mass != nullptr) {
        nlohmann::ordered_json rows;
        for (std::size_t i = 0; i < 6; ++i)
            rows.push_back(std::vector<double>(mass->matrix.begin() + static_cast<std::ptrdiff_t>(6 * i),
                                               mass->matrix.begin() + static_cast<std::ptrdiff_t>(6 * i + 6)));
        j["added_mass"] = {{"density", o.density},
                           {"matrix", rows},
                           {"error", mass->error},
                           {"buried", mass->buried},
                           {"triangles", mass->triangles}};
    }
    std::printf("%s\n", j.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
}

void print_added_mass(const Options& o, const bake::AddedMass& mass) {
    std::printf("added mass at %.6g kg/m^3, about the mesh's origin, in kg, kg m and kg m^2; estimated error %.1f %%\n",
                o.density, 100 * mass.error);
    double most[2] = {};
    for (std::size_t i = 0; i < 6; ++i) most[i / 3] = std::fmax(most[i / 3], mass.matrix[7 * i]);
    for (std::size_t i = 0; i < 6; ++i) {
        std::printf("%10s", i < 3 ? "force" : "torque");
        std::printf(" %c", "xyz"[i % 3]);
        for (std::size_t j = 0; j < 6; ++j) {
            const double x = mass.matrix[6 * i + j], least = 1e-6 * std::sqrt(most[i / 3] * most[j / 3]);
            std::printf(" %12.5g", std::fabs(x) < least ? 0.0 : x);
        }
        std::printf("\n");
    }
}

void print_regions(const std::vector<Choice>& choices) {
    std::printf("regions    quality    budget  sources    error   wet ratio   velocity   arm\n");
    for (const Choice& c : choices) {
        const bake::RegionErrors& e = c.chosen.errors;
        std::printf("           %-8s  %5.1f %%    %5u  %5.1f %%     %5.1f %%    %5.1f %%   %5.1f %%%s\n", c.quality,
                    100 * c.budget, c.chosen.regions.count, 100 * e.whole, 100 * e.wet_ratio, 100 * e.velocity,
                    100 * e.arm, c.chosen.reached ? "" : "   more than the budget: all that there may be");
    }
}

void print_text(const bake::Repaired& r, const bake::SurfaceProperties& shape, const bake::Thickness& thickness,
                const bake::Symmetry& symmetry, const std::vector<Choice>& choices) {
    const Vec3d size = shape.high - shape.low;
    // What is left of rounding, to be read as the zero that it is.
    const auto tidy = [&](double x) { return std::fabs(x) < 1e-9 * length(size) ? 0.0 : x; };
    std::printf("size       %.4g x %.4g x %.4g m, from (%.4g, %.4g, %.4g) to (%.4g, %.4g, %.4g)\n", size.x, size.y,
                size.z, shape.low.x, shape.low.y, shape.low.z, shape.high.x, shape.high.y, shape.high.z);
    std::printf("surface    %zu triangles, %.4g m^2, %u closed piece%s\n", r.surface.triangles.size(), shape.area,
                r.shells, r.shells == 1 ? "" : "s");
    std::printf("volume     %.4g m^3, centroid (%.4g, %.4g, %.4g) m\n", shape.volume, tidy(shape.centroid.x),
                tidy(shape.centroid.y), tidy(shape.centroid.z));
    if (thickness.thinnest > 0) {
        std::printf(
            "thickness  %.4g mm where it is thinnest (1 %% of the surface), near (%.4g, %.4g, %.4g); median %.4g mm\n",
            thickness.thinnest * 1000, thickness.thinnest_at.x, thickness.thinnest_at.y, thickness.thinnest_at.z,
            thickness.median * 1000);
    }
    std::printf("symmetry   %s\n", bake::describe(symmetry).c_str());
    if (!choices.empty()) print_regions(choices);
    for (const std::string& note : r.notes) std::printf("note       %s\n", note.c_str());
    if (r.notes.empty()) std::printf("repairs    none needed\n");
}

void run(const Options& o) {
    require_distinct({o.out}, {o.mesh});
    if (!o.out.empty()) require_writable(o.out);
    bake::Repaired repaired =
        load_or_show(o.mesh, o.out, [&] { return bake::repair(bake::load_gltf(o.mesh, o.scale), o.mesh); });
    if (!o.out.empty()) write_file(o.out, bake::write_glb({{"surface", {0.5, 0.5, 0.5, 1}, &repaired.surface}}, "frm"));
    const bake::SurfaceProperties shape = bake::measure(repaired.surface);
    note_size(shape, o.scale, repaired.notes);
    const bake::Thickness thickness = bake::measure_thickness(repaired.surface);
    const bake::Symmetry symmetry = bake::find_symmetry(repaired.surface);
    const std::vector<Choice> choices = o.regions ? choose(repaired.surface) : std::vector<Choice>{};
    bake::AddedMass mass;
    if (o.added_mass) {
        bake::AddedMassSettings settings;
        settings.density = o.density;
        mass = bake::added_mass(repaired.surface, settings);
    }
    if (o.json) {
        print_json(o, repaired, shape, thickness, symmetry, choices, o.added_mass ? &mass : nullptr);
        return;
    }
    print_text(repaired, shape, thickness, symmetry, choices);
    if (o.added_mass) print_added_mass(o, mass);
}

}  // namespace

void add_mesh(CLI::App& app) {
    auto options = std::make_shared<Options>();
    Options& o = *options;
    CLI::App* command =
        app.add_subcommand("mesh", "Shows what a bake would make of a mesh: measures, repairs, or why it is refused.");
    command->footer(
        "A refused shape is written to NAME.problem.glb, the place marked red, beside the output file or here.\n"
        "The errors of regions are shares of force and torque of a body that turns half out of the water: in all, and "
        "by\n"
        "one wet ratio, one velocity, one point of attack for a region.\n"
        "  frm mesh paddle.glb\n"
        "  frm mesh paddle.glb --regions\n"
        "  frm mesh paddle.glb --added-mass       what the water adds to its inertia; some seconds");
    command->add_option("MESH", o.mesh, "a .glb or .gltf file, in metres")
        ->required()
        ->check(not_empty())
        ->type_name("");
    add_scale(*command, o.scale);
    command->add_option("-o,--out", o.out, "write the repaired surface to this .glb file")
        ->check(not_empty())
        ->type_name("FILE");
    CLI::Option* added_mass =
        command->add_flag("--added-mass", o.added_mass,
                          "the 6x6 added mass in unbounded water without friction, and its estimated error");
    command->add_option("--density", o.density, "of the fluid of --added-mass, kg/m^3")
        ->check(density_range())
        ->type_name("N")
        ->capture_default_str()
        ->needs(added_mass);
    command->add_flag("--regions", o.regions,
                      "also how many haptic regions each quality needs, and their errors (docs/regions.md)");
    command->add_flag("--json", o.json, "JSON on standard output");
    command->callback([options] { run(*options); });
}

}  // namespace frm::cli
