// frm flow: one run of the solver, no map.
#include "bake/flow/flow.h"

#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "bake/bake.h"
#include "bake/series/spectrum.h"
#include "cli/command.h"
#include "cli/file.h"
#include "cli/progress.h"

namespace frm::cli {
namespace {

struct Options {
    bake::FlowCase flow;
    std::string mesh, out;
    Numbers direction{}, section{};
    bool automatic_section = false;
    double length = 0;
    bool json = false;
};

struct Results {
    Vec3d force_mean, force_rms, torque_mean;
    double cd = 0, cl = 0, cl_rms = 0, strouhal = 0;
};

Vec3d force_at(const bake::FlowSeries& flow, std::size_t sample) {
    Vec3d sum;
    for (std::size_t l = 0; l < flow.regions; ++l)
        for (int c = 0; c < 3; ++c) {
            const std::size_t at = (sample * flow.regions + l) * 3 + static_cast<std::size_t>(c);
            sum[c] += static_cast<double>(flow.pressure[at]) + static_cast<double>(flow.friction[at]);
        }
    return sum;
}

/// The direction across the stream in which the force swings most, by power iteration on its covariance.
Vec3d swing(const std::vector<Vec3d>& lift) {
    Vec3d axis(0.4, 0.5, 0.6);
    for (int i = 0; i < 50; ++i) {
        Vec3d next;
        for (const Vec3d& v : lift) next += v * dot(v, axis);
        const double size = length(next);
        if (!(size > 0)) return {0, 0, 0};
        axis = next / size;
    }
    return axis;
}

Results evaluate(const bake::FlowSeries& flow, const bake::FlowCase& c, double length_used) {
    Results r;
    std::vector<Vec3d> force(flow.samples);
    for (std::size_t s = 0; s < flow.samples; ++s) {
        force[s] = force_at(flow, s);
        r.force_mean += force[s] / static_cast<double>(flow.samples);
        for (int k = 0; k < 3; ++k)
            r.torque_mean[k] += static_cast<double>(flow.torque[s * 3 + static_cast<std::size_t>(k)]) / flow.samples;
    }
    std::vector<Vec3d> lift(flow.samples);
    Vec3d square;
    for (std::size_t s = 0; s < flow.samples; ++s) {
        const Vec3d change = force[s] - r.force_mean;
        for (int k = 0; k < 3; ++k) square[k] += change[k] * change[k] / flow.samples;
        lift[s] = change - c.direction * dot(change, c.direction);
    }
    for (int k = 0; k < 3; ++k) r.force_rms[k] = std::sqrt(square[k]);

    const double unit = 0.5 * c.density * c.speed * c.speed * flow.plan.projected_area;
    const double drag = dot(r.force_mean, c.direction);
    r.cd = drag / unit;
    r.cl = length(r.force_mean - c.direction * drag) / unit;
    const Vec3d axis = swing(lift);
    std::vector<float> signal(flow.samples);
    double lift_square = 0;
    for (std::size_t s = 0; s < flow.samples; ++s) {
        signal[s] = static_cast<float>(dot(lift[s], axis));
        lift_square += dot(lift[s], lift[s]) / flow.samples;
    }
    r.cl_rms = std::sqrt(lift_square) / unit;
    const bake::Peak peak = bake::strongest_peak(signal, flow.interval);
    if (peak.amplitude > 0.005 * std::fabs(drag)) r.strouhal = peak.frequency * length_used / c.speed;
    return r;
}

std::string csv(const bake::FlowSeries& flow) {
    std::string text =
        "time,fx,fy,fz,fx_pressure,fy_pressure,fz_pressure,fx_friction,fy_friction,fz_friction,tx,ty,tz\n";
    for (std::size_t s = 0; s < flow.samples; ++s) {
        const Vec3d total = force_at(flow, s);
        Vec3d pressure;
        for (std::size_t l = 0; l < flow.regions; ++l)
            for (int c = 0; c < 3; ++c)
                pressure[c] +=
                    static_cast<double>(flow.pressure[(s * flow.regions + l) * 3 + static_cast<std::size_t>(c)]);
        const Vec3d friction = total - pressure;
        char line[320];
        std::snprintf(line, sizeof line, "%.9g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g,%.7g\n",
                      static_cast<double>(s) * flow.interval, total.x, total.y, total.z, pressure.x, pressure.y,
                      pressure.z, friction.x, friction.y, friction.z, static_cast<double>(flow.torque[s * 3]),
                      static_cast<double>(flow.torque[s * 3 + 1]), static_cast<double>(flow.torque[s * 3 + 2]));
        text += line;
    }
    return text;
}

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

void run(Options& o, bool section) {
    o.flow.direction = {o.direction[0], o.direction[1], o.direction[2]};
    require_distinct({o.out}, {o.mesh});
    if (!o.out.empty()) require_writable(o.out);

    std::vector<std::string> notes;
    const bake::Surface surface = bake::load_surface(o.mesh, notes);
    bake::Regions whole;
    whole.region.assign(surface.triangles.size(), 0);
    whole.count = 1;
    if (section) {
        o.flow.section = true;
        o.flow.section_origin = bake::measure(surface).centroid;
        o.flow.section_normal = o.automatic_section ? longest_across(surface, o.flow.direction)
                                                    : Vec3d(o.section[0], o.section[1], o.section[2]);
        if (std::fabs(dot(o.flow.section_normal, o.flow.direction)) > 1e-6)
            throw CLI::ValidationError("--section", "the normal must be at right angles to --direction");
    }
    const bake::FlowPlan plan = bake::plan_flow(surface, o.flow);
    if (!plan.warning.empty()) notes.push_back(plan.warning);
    for (const std::string& note : notes) std::fprintf(stderr, "note: %s\n", note.c_str());

    bake::FlowSeries flow;
    {
        ProgressBar bar("flow");
        flow = bake::solve_flow(surface, whole, o.flow,
                                [&](const bake::FlowState& state) { return bar.update(state.share, ""); });
    }
    const double length_used = o.length > 0 ? o.length
                               : section    ? plan.reference_length
                                            : std::sqrt(plan.projected_area);
    const Results r = evaluate(flow, o.flow, length_used);
    const double reynolds = o.flow.speed * length_used / o.flow.viscosity;
    if (!o.out.empty()) write_file(o.out, csv(flow));
    if (o.json) {
        const auto vec = [](const Vec3d& v) { return nlohmann::ordered_json{v.x, v.y, v.z}; };
        nlohmann::ordered_json j;
        j["force_mean"] = vec(r.force_mean);
        j["force_rms"] = vec(r.force_rms);
        j["torque_mean"] = vec(r.torque_mean);
        j["area"] = plan.projected_area;
        j["length"] = length_used;
        j["reynolds"] = reynolds;
        j["reynolds_solved"] = reynolds * plan.reynolds_solved / plan.reynolds;
        j["cd"] = r.cd;
        j["cl"] = r.cl;
        j["cl_rms"] = r.cl_rms;
        j["strouhal"] = r.strouhal > 0 ? nlohmann::ordered_json(r.strouhal) : nlohmann::ordered_json();
        j["uncertainty"] = flow.uncertainty.total();
        j["blockage"] = plan.blockage;
        j["cells"] = plan.cells;
        j["steps"] = plan.steps;
        j["mlups"] = flow.mlups;
        j["seconds"] = flow.seconds;
        std::printf("%s\n", j.dump(2).c_str());
        return;
    }
    if (o.out.empty()) std::printf("%s", csv(flow).c_str());
    std::FILE* to = o.out.empty() ? stderr : stdout;
    std::fprintf(to, "force %.5g, %.5g, %.5g N%s; drag coefficient %.4f +- %.1f %% on %.5g m^2%s, lift %.4f (rms %.4f)",
                 r.force_mean.x, r.force_mean.y, r.force_mean.z, section ? " a metre" : "", r.cd,
                 100 * flow.uncertainty.total(), plan.projected_area, section ? " a metre" : "", r.cl, r.cl_rms);
    if (r.strouhal > 0) std::fprintf(to, ", Strouhal number %.4f", r.strouhal);
    std::fprintf(to,
                 "\nReynolds number %.4g (solved %.4g) on %.4g m; %llu cells, %llu steps, %.1f s, %.0f million cell "
                 "updates a second\n",
                 reynolds, reynolds * plan.reynolds_solved / plan.reynolds, length_used,
                 static_cast<unsigned long long>(plan.cells), static_cast<unsigned long long>(plan.steps), flow.seconds,
                 flow.mlups);
}

}  // namespace

void add_flow(CLI::App& app) {
    auto options = std::make_shared<Options>();
    Options& o = *options;
    CLI::App* command = app.add_subcommand(
        "flow", "Solves one uniform stream past a mesh and gives the force over time, without making a map.");
    command->footer("  frm flow sphere.glb --direction 1,0,0 --speed 0.001 --json");
    command->add_option("MESH", o.mesh, "a .glb or .gltf file, closed, in metres")
        ->required()
        ->check(not_empty())
        ->type_name("");
    add_direction(*command, "--direction", o.direction, "where the water goes, in the mesh's frame")->required();
    command->add_option("--speed", o.flow.speed, "of the stream, m/s")
        ->required()
        ->check(stream_speed_range())
        ->type_name("N");
    command->add_option("--viscosity", o.flow.viscosity, "kinematic, m^2/s")
        ->check(viscosity_range())
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--density", o.flow.density, "kg/m^3")
        ->check(density_range())
        ->type_name("N")
        ->capture_default_str();
    CLI::Option* section =
        add_direction_or_auto(*command, "--section", o.section, o.automatic_section,
                              "solve in two dimensions the cut through the centroid, across this normal\n"
                              "(default: the mesh's longest axis across the stream).\n"
                              "Forces and area are then for a metre of span");
    command
        ->add_option("--length", o.length,
                     "of the Reynolds and Strouhal numbers, m (default: the root of the projected area)")
        ->check(positive())
        ->type_name("N");
    command->add_option("--resolution", o.flow.resolution, "grid cells across the reference length, 4 to 512")
        ->check(number_within(4, 512))
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--start-up", o.flow.start_up, "reference lengths travelled before the series begins, 0.5 at least")
        ->check(number_within(0.5, 1e4))
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--duration", o.flow.duration, "reference lengths travelled during the series, 0.5 at least")
        ->check(number_within(0.5, 1e5))
        ->type_name("N")
        ->capture_default_str();
    command->add_option("--threads", o.flow.threads, "0: all cores. The result does not depend on it")
        ->check(whole_within(0, 256))
        ->type_name("N")
        ->capture_default_str();
    command->add_option("-o,--out", o.out, "write the series to this CSV file (default: standard output)")
        ->check(not_empty())
        ->type_name("FILE");
    command->add_flag("--json", o.json, "means and coefficients as JSON on standard output, no series there");
    command->callback([options, section] { run(*options, section->count() > 0); });
}

}  // namespace frm::cli
