#include "cli/mesh_size.h"

#include <unistd.h>

#include <cstddef>
#include <cstdio>
#include <iostream>

#include "bake/mesh/gltf.h"
#include "bake/mesh/units.h"

namespace frm::cli {
namespace {

std::string number(const char* format, double v) {
    char text[32];
    std::snprintf(text, sizeof text, format, v);
    return text;
}

std::string metres(double v) { return number("%.3g", v) + " m"; }

/// "in inches, add --scale 0.0254 (0.762 m), in centimetres ..."
std::string remedies(double extent) {
    std::string text;
    for (const bake::Unit& unit : bake::likely_units(extent)) {
        if (!text.empty()) text += ", ";
        text += std::string("in ") + unit.name + (text.empty() ? ", add" : "") + " --scale " +
                number("%g", unit.scale) + " (" + metres(extent * unit.scale) + ")";
    }
    return text;
}

/// One of so many answers; 0 for anything else, the end of the input too.
std::size_t ask(std::size_t answers) {
    std::fprintf(stderr, "[1-%zu] ", answers);
    std::fflush(stderr);
    std::string line;
    if (!std::getline(std::cin, line) || line.size() != 1 || line[0] < '1') return 0;
    const auto answer = static_cast<std::size_t>(line[0] - '0');
    return answer <= answers ? answer : 0;
}

}  // namespace

void add_scale(CLI::App& command, double& scale) {
    command
        .add_option("--scale", scale,
                    "multiply the mesh's size: 0.001 for one drawn in millimetres, 0.01\n"
                    "centimetres, 0.0254 inches (default: 1)")
        ->check(number_within(1e-6, 1e6))
        ->type_name("F");
}

void note_size(const bake::SurfaceProperties& shape, double scale, std::vector<std::string>& notes) {
    const double extent = bake::longest_side(shape);
    if (scale != 1 || bake::plausible_size(extent)) return;
    notes.push_back("the mesh is " + metres(extent) + " long, as glTF counts in metres; if it was drawn " +
                    remedies(extent));
}

void settle_size(const std::string& mesh, double& scale) {
    const double extent = bake::extent_of_gltf(mesh);
    if (bake::plausible_size(extent)) return;
    const std::string as_it_is = metres(extent);
    if (!isatty(STDIN_FILENO) || !isatty(STDERR_FILENO))
        throw Failure(mesh + ": is " + as_it_is + " long, as glTF counts in metres. If it was drawn " +
                      remedies(extent) + "; if " + as_it_is + " is right, add --yes");
    std::fprintf(stderr, "%s is %s long, as glTF counts in metres. Was it drawn in\n", mesh.c_str(), as_it_is.c_str());
    const std::vector<bake::Unit> units = bake::likely_units(extent);
    for (std::size_t n = 0; n < units.size(); ++n)
        std::fprintf(stderr, "  %zu  %s: %s\n", n + 1, units[n].name, metres(extent * units[n].scale).c_str());
    std::fprintf(stderr, "  %zu  metres: %s is right\n", units.size() + 1, as_it_is.c_str());
    const std::size_t answer = ask(units.size() + 1);
    if (answer == 0) throw Failure(mesh + ": say by how much its size is to be multiplied: --scale F");
    if (answer <= units.size()) scale = units[answer - 1].scale;
}

}  // namespace frm::cli
