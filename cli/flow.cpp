// frm flow: one run of the solver, no map.
#include "bake/flow/flow.h"

#include <cmath>
#include <cstdio>
#include <memory>

#include "bake/bake.h"
#include "cli/command.h"
#include "cli/file.h"
#include "cli/flow_report.h"
#include "cli/flow_results.h"
#include "cli/mesh_size.h"
#include "cli/problem_file.h"
#include "cli/progress.h"

namespace frm::cli {
namespace {

struct Options {
    bake::FlowCase flow;
    std::string mesh, out, report;
    Numbers direction{}, section{}, section_point{}, spin{};
    bool has_direction = false, has_section = false, automatic_section = false, has_spin = false, has_slab = false,
         has_section_point = false;
    double length = 0, confidence = 0, memory = 0, scale = 1;
    bool no_grid_error = false, json = false;
};

constexpr double mib = 1 << 20, gib = 1 << 30;

/// The longest extent of the mesh across the stream: how a section is cut if nobody says.
Vec3d longest_across(const bake::Surface& surface, const Vec3d& direction) {
    const bake::SurfaceProperties shape = bake::measure(surface);
    const Vec3d size = shape.high - shape.low;
    Vec3d best;
    double longest = -1;
    for (int k = 0; k < 3; ++k) {
        Vec3d axis;
        axis[k] = 1;
        const double across = std::fabs(dot(axis, direction)) < 1e-6 ? size[k] : -1;
        if (across > longest) longest = across, best = axis;
    }
    if (longest < 0)
        throw Failure(
            "--section: no axis of the mesh lies across the direction; give the section's normal: --section x,y,z");
    return best;
}

/// Where nothing but a spin drives the flow, the direction only says whose projected area the reference length is of:
/// the axis of the mesh, away from the spin's, along which the mesh looks largest.
Vec3d direction_for_spin(const bake::Surface& surface, const Vec3d& spin) {
    const bake::SurfaceProperties shape = bake::measure(surface);
    const Vec3d size = shape.high - shape.low;
    Vec3d best;
    double largest = -1;
    for (int k = 0; k < 3; ++k) {
        const double area = size[(k + 1) % 3] * size[(k + 2) % 3];
        if (std::fabs(spin[k]) > 0.6 * length(spin) || area <= largest) continue;  // at least one is under 1 / root 3
        largest = area;
        best = {};
        best[k] = 1;
    }
    return best;
}

/// What the solver calls its fields, as options.
std::string with_options(std::string text) {
    constexpr const char* names[][2] = {{"section_origin", "--section-point"},
                                        {"section_normal", "--section"},
                                        {"start_up", "--start-up"},
                                        {"memory_limit", "--memory"}};
    for (const auto& [field, option] : names)
        if (const std::size_t at = text.find(field); at != std::string::npos)
            text.replace(at, std::string(field).size(), option);
    return text;
}

/// What `solve` returns. Where it refuses the case, its fields are named as the options that they come from.
template <typename Solve>
auto in_options(Solve solve) -> decltype(solve()) {
    try {
        return solve();
    } catch (const bake::FlowCancelled&) {
        throw;
    } catch (const bake::BakeError& error) {
        throw Failure(with_options(error.what()));
    }
}

/// What can be said of the options before the mesh is read.
void check(const Options& o) {
    if (o.has_spin && !(length(o.spin) > 0)) throw CLI::ValidationError("--spin", "is zero: leave it out");
    if (o.flow.speed == 0 && !o.has_spin)
        throw CLI::ValidationError("--speed", "0 is for a body that spins (--spin); else it is from 1e-06 to 10000");
    if (!o.has_direction && o.flow.speed > 0) throw CLI::RequiredError("--direction");
    if (o.has_slab && !o.has_section) throw CLI::ValidationError("--slab", "is the span of a section: add --section");
    if (o.has_section_point && !o.has_section)
        throw CLI::ValidationError("--section-point", "is where a section is cut: add --section");
    std::vector<std::string> outputs{o.out};
    if (!o.report.empty())
        for (const std::string& path : FlowReport::files(o.report)) outputs.push_back(path);
    require_distinct(outputs, {o.mesh});
}

/// The solver's case. It asks for the mesh where an option leaves something open.
void complete(Options& o, const bake::Surface& surface) {
    bake::FlowCase& c = o.flow;
    c.direction = {o.direction[0], o.direction[1], o.direction[2]};
    c.confidence = o.confidence / 100;
    c.grid_error = !o.no_grid_error;
    c.pictures = !o.report.empty();
    c.memory_limit = static_cast<std::uint64_t>(o.memory * gib);
    c.spin = {o.spin[0], o.spin[1], o.spin[2]};
    c.spin_centre = bake::measure(surface).centroid;
    if (!o.has_direction) c.direction = direction_for_spin(surface, c.spin);
    if (!o.has_section) return;
    c.section = true;
    c.section_origin =
        o.has_section_point ? Vec3d(o.section_point[0], o.section_point[1], o.section_point[2]) : c.spin_centre;
    c.section_normal =
        o.automatic_section ? longest_across(surface, c.direction) : Vec3d(o.section[0], o.section[1], o.section[2]);
    if (std::fabs(dot(c.section_normal, c.direction)) > 1e-6)
        throw CLI::ValidationError("--section", "the normal must be at right angles to --direction");
}

std::string count_text(std::uint64_t count) {
    char text[48];
    const auto value = static_cast<double>(count);
    if (value < 1e5)
        std::snprintf(text, sizeof text, "%.0f cells", value);
    else
        std::snprintf(text, sizeof text, "%.3g million cells", value / 1e6);
    return text;
}

void print_plan(const bake::FlowPlan& plan, double length) {
    const double share = length / plan.reference_length;
    std::fprintf(stderr, "%s in %zu block%s, finest %.3g mm; %.0f MiB; Reynolds number %.4g (solved %.4g)\n",
                 count_text(plan.cells).c_str(), plan.blocks.size(), plan.blocks.size() == 1 ? "" : "s",
                 1e3 * plan.cell, std::ceil(static_cast<double>(plan.bytes) / mib), plan.reynolds * share,
                 plan.reynolds_solved * share);
}

std::string note_of(const bake::FlowState& state, bool spin_alone) {
    std::string text = state.coarse ? "coarse grid: " : "";
    if (!state.recording) return text + "starting";
    char number[64];
    std::snprintf(number, sizeof number, "%s %.3f", spin_alone ? "torque" : "drag", state.drag_coefficient);
    text += number;
    if (state.statistics > 0) {
        std::snprintf(number, sizeof number, " +- %.1f %%", 100 * state.statistics);
        text += number;
    }
    return text;
}

bake::FlowSeries solve(const bake::Surface& surface, const bake::FlowCase& c) {
    bake::Regions whole;
    whole.region.assign(surface.triangles.size(), 0);
    whole.count = 1;
    ProgressBar bar("flow");
    return bake::solve_flow(surface, whole, c, [&](const bake::FlowState& state) {
        return bar.update(state.share, state.seconds_left, note_of(state, c.speed == 0));
    });
}

/// How the run ended, where that is not at its full duration; and what that means for what was asked for.
std::string ending_text(const Options& o, const bake::FlowSeries& flow, const FlowResults& r) {
    char text[160];
    const char* why = nullptr;
    switch (flow.ending) {
        case bake::FlowEnding::confidence:
            why = "the confidence asked for is reached";
            break;
        case bake::FlowEnding::seconds:
            why = "the time of --seconds is over";
            break;
        case bake::FlowEnding::cancelled:
            why = "interrupted";
            break;
        case bake::FlowEnding::duration:
            if (!(o.flow.confidence > 0) || flow.uncertainty.statistics <= o.flow.confidence) return "";
            std::snprintf(text, sizeof text, "--confidence %g is not reached in %g lengths: raise --duration\n",
                          o.confidence, r.longest);
            return text;
    }
    std::snprintf(text, sizeof text, "stopped early: %s, after %.4g of at most %g lengths%s\n", why, r.travelled,
                  r.longest, flow.half ? " of the run on half the resolution" : "");
    return text;
}

std::string uncertainty_text(const bake::FlowUncertainty& u) {
    char text[128], grid[32];
    std::snprintf(grid, sizeof grid, u.grid < 0 ? "not measured" : "%.1f %%", 100 * u.grid);
    std::snprintf(text, sizeof text, "%s%.1f %% (grid %s, statistics %.1f %%, blockage %.1f %%)",
                  u.grid < 0 ? "at least " : "", 100 * u.total(), grid, 100 * u.statistics, 100 * u.blockage);
    return text;
}

void print(std::FILE* to, const Options& o, const bake::FlowSeries& flow, const FlowResults& r) {
    const bool section = o.flow.section, spin_alone = o.flow.speed == 0;
    std::fprintf(to, "force %.5g, %.5g, %.5g N%s; ", r.force_mean.x, r.force_mean.y, r.force_mean.z,
                 section ? " a metre" : "");
    const std::string uncertainty = uncertainty_text(flow.uncertainty);
    if (spin_alone) {
        std::fprintf(to, "torque coefficient %.4g +- %s\n", r.torque_coefficient, uncertainty.c_str());
    } else {
        std::fprintf(to, "drag coefficient %.4f +- %s on %.5g m^2%s\n", r.cd, uncertainty.c_str(),
                     flow.plan.projected_area, section ? " a metre" : "");
        std::fprintf(to, "lift %.4f (rms %.4f)", r.cl, r.cl_rms);
        if (r.strouhal > 0) std::fprintf(to, ", Strouhal number %.4f", r.strouhal);
        if (o.has_spin) std::fprintf(to, ", torque coefficient %.4g", r.torque_coefficient);
        std::fputc('\n', to);
    }
    std::fprintf(to,
                 "Reynolds number %.4g (solved %.4g) on %.4g m; %llu cells, %llu steps, %.1f s, %.0f million cell "
                 "updates a second\n",
                 r.reynolds, r.reynolds_solved, r.length, static_cast<unsigned long long>(flow.plan.cells),
                 static_cast<unsigned long long>(flow.steps), flow.seconds, flow.mlups);
}

void run(Options& o) {
    check(o);
    if (!o.out.empty()) require_writable(o.out);

    std::vector<std::string> notes;
    const bake::Surface surface =
        load_or_show(o.mesh, o.out, [&] { return bake::load_surface(o.mesh, notes, o.scale); });
    note_size(bake::measure(surface), o.scale, notes);
    complete(o, surface);
    const bake::FlowPlan plan = in_options([&] { return bake::plan_flow(surface, o.flow); });
    const std::unique_ptr<FlowReport> report =
        o.report.empty() ? nullptr : std::make_unique<FlowReport>(o.report, std::vector<std::string>{o.out});
    if (!plan.warning.empty()) notes.push_back(plan.warning);
    for (const std::string& note : notes) std::fprintf(stderr, "note: %s\n", note.c_str());
    print_plan(plan, length_of(o.flow, plan, o.length));

    const bake::FlowSeries flow = in_options([&] { return solve(surface, o.flow); });
    const FlowResults results = evaluate(surface, o.flow, flow, o.length);
    if (!o.out.empty()) write_file(o.out, csv_of(flow));
    const bool bare = o.out.empty() && o.report.empty() && !o.json;  // the series is all of standard output
    // The report first: who reads standard output may be gone by then.
    if (report) report->write({o.mesh, notes, o.flow}, flow, results);
    if (o.json) std::printf("%s\n", json_of(flow, results).dump(2).c_str());
    if (bare) std::printf("%s", csv_of(flow).c_str());
    if (!o.json) print(bare ? stderr : stdout, o, flow, results);
    if (report && !o.json) std::printf("report in %s/report.html\n", o.report.c_str());
    std::fflush(stdout);
    std::fprintf(stderr, "%s", ending_text(o, flow, results).c_str());
    if (flow.ending == bake::FlowEnding::cancelled) throw Unsuccessful();
}

void add_case(CLI::App& command, Options& o) {
    command.add_option("MESH", o.mesh, "a .glb or .gltf file, closed, in metres")
        ->required()
        ->check(not_empty())
        ->type_name("");
    add_scale(command, o.scale);
    add_direction(command, "--direction", o.direction,
                  "where the water goes, in the mesh's frame (not needed with --speed 0)");
    command.add_option("--speed", o.flow.speed, "of the stream, m/s; 0 only with --spin")
        ->required()
        ->check(speed_or_zero())
        ->type_name("N");
    command.add_option("--viscosity", o.flow.viscosity, "kinematic, m^2/s")
        ->check(viscosity_range())
        ->type_name("N")
        ->capture_default_str();
    command.add_option("--density", o.flow.density, "kg/m^3")
        ->check(density_range())
        ->type_name("N")
        ->capture_default_str();
    add_vector(command, "--spin", o.spin, 1e6,
               "rad/s; the mesh turns about the axis through its centroid: any mesh with\n"
               "--speed 0, in a stream a body of revolution (default: it stands)");
    add_direction_or_auto(command, "--section", o.section, o.automatic_section,
                          "solve in two dimensions the cut through the mesh across this normal\n"
                          "(default: the mesh's longest axis across the stream).\n"
                          "Forces and area are then for a metre of span");
    add_vector(command, "--section-point", o.section_point, 1e6,
               "a point that the section goes through, m, in the mesh's frame (default:\n"
               "the centroid)");
    command
        .add_option("--slab", o.flow.slab,
                    "of a section, solve so many reference lengths of span in three dimensions:\n"
                    "its wake needs them above a Reynolds number of 200 (default: none)")
        ->check(number_within(0.1, 100))
        ->type_name("N");
    command
        .add_option("--length", o.length,
                    "of the Reynolds and Strouhal numbers, m (default: the root of the projected area)")
        ->check(positive())
        ->type_name("N");
}

void add_effort(CLI::App& command, Options& o) {
    command.add_option("--resolution", o.flow.resolution, "finest cells across the reference length, 4 to 512")
        ->check(number_within(4, 512))
        ->type_name("N")
        ->capture_default_str();
    command
        .add_option("--start-up", o.flow.start_up, "reference lengths travelled before the series begins, 0.5 at least")
        ->check(number_within(0.5, 1e4))
        ->type_name("N")
        ->capture_default_str();
    command
        .add_option("--duration", o.flow.duration,
                    "reference lengths travelled during the series, 0.5 at least; with\n"
                    "--confidence the most there may be")
        ->check(number_within(0.5, 1e5))
        ->type_name("N")
        ->capture_default_str();
    command
        .add_option("--confidence", o.confidence,
                    "stop once the standard error of the mean drag over time is below so many\n"
                    "per cent of it, such as 3 (default: run for --duration)")
        ->check(number_within(0.1, 100))
        ->type_name("PERCENT");
    command
        .add_option("--seconds", o.flow.seconds,
                    "stop after so much wall time, with the series up to there (default: 0, no\nlimit)")
        ->check(number_within(0, 1e8))
        ->type_name("S");
    command.add_flag("--no-grid-error", o.no_grid_error,
                     "leave out the run on half the resolution, a sixteenth of the work, which\n"
                     "tells the error of the grid");
    command
        .add_option("--turn", o.flow.turn,
                    "turn the grid about the stream (of a mesh that turns: about the spin) by so\nmany degrees")
        ->check(number_within(-360, 360))
        ->type_name("DEGREES")
        ->capture_default_str();
    command.add_option("--memory", o.memory, "refuse what needs more, GiB (default: three quarters of this machine's)")
        ->check(number_within(0.001, 1e5))
        ->type_name("GIB");
    command.add_option("--threads", o.flow.threads, "0: all cores. The result does not depend on it")
        ->check(whole_within(0, 256))
        ->type_name("N")
        ->capture_default_str();
}

void add_output(CLI::App& command, Options& o) {
    command
        .add_option("-o,--out", o.out,
                    "write the series to this CSV file (default: standard output, but for\n--json and --report)")
        ->check(not_empty())
        ->type_name("FILE");
    command
        .add_option("--report", o.report,
                    "write report.html, flow.json, series.csv and slices of the flow to this\n"
                    "folder (needs python3-matplotlib)")
        ->check(not_empty())
        ->type_name("DIR");
    command.add_flag("--json", o.json, "means and coefficients as JSON on standard output, no series there");
}

}  // namespace

void add_flow(CLI::App& app) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand(
        "flow", "Solves one uniform stream past a mesh and gives the force over time, without making a map.");
    command->footer(
        "Ctrl-C ends a run and keeps what is known by then.\n"
        "  frm flow sphere.glb --direction 1,0,0 --speed 0.001 --json\n"
        "  frm flow sphere.glb --direction 1,0,0 --speed 0.001 --duration 200 --confidence 1 --report out");
    add_case(*command, *options);
    add_effort(*command, *options);
    add_output(*command, *options);
    command->callback([options, command] {
        options->has_direction = command->count("--direction") > 0;
        options->has_section = command->count("--section") > 0;
        options->has_section_point = command->count("--section-point") > 0;
        options->has_spin = command->count("--spin") > 0;
        options->has_slab = command->count("--slab") > 0;
        run(*options);
    });
}

}  // namespace frm::cli
