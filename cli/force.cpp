// frm force: what a map gives for a steady motion, deep under water.
#include <cmath>
#include <cstdio>
#include <memory>

#include "cli/command.h"
#include "cli/frm_object.h"
#include "cli/progress.h"

namespace frm::cli {
namespace {

struct Options {
    std::string file;
    Numbers velocity{}, spin{};
    double seconds = 0, density = 0, viscosity = 0, scale = 1;
    bool json = false;
};

/// Mean and root mean square of the change, one component each.
struct Statistics {
    Numbers sum{}, squares{};
    std::size_t count = 0;

    void add(const frm_vec3& v) {
        const Numbers n{static_cast<double>(v.x), static_cast<double>(v.y), static_cast<double>(v.z)};
        for (std::size_t k = 0; k < 3; ++k) sum[k] += n[k], squares[k] += n[k] * n[k];
        ++count;
    }
    Numbers mean() const {
        Numbers m{};
        for (std::size_t k = 0; k < 3; ++k) m[k] = sum[k] / static_cast<double>(count);
        return m;
    }
    Numbers rms() const {
        Numbers r{};
        const Numbers m = mean();
        for (std::size_t k = 0; k < 3; ++k)
            r[k] = std::sqrt(std::fmax(0, squares[k] / static_cast<double>(count) - m[k] * m[k]));
        return r;
    }
};

frm_vec3 plain(const Numbers& n) {
    return {static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])};
}

void run(const Options& o) {
    if (length(o.velocity) + length(o.spin) == 0)
        throw CLI::ValidationError("--velocity",
                                   "and --spin are both zero: a body at rest in still water feels no force");

    const Session session;
    const frm_map map = session.open_map(o.file);
    const frm_map_info info = session.map_info(map);
    frm_world_def world_def;
    session.check(frm_world_def_init(&world_def, sizeof world_def));
    world_def.surface = FRM_SURFACE_NONE;
    world_def.density = o.density > 0 ? static_cast<float>(o.density) : info.density;
    world_def.viscosity = o.viscosity > 0 ? static_cast<float>(o.viscosity) : info.viscosity;
    frm_world world = 0;
    session.check(frm_world_create(session.context(), &world_def, &world));
    frm_body_def body_def;
    session.check(frm_body_def_init(&body_def, sizeof body_def));
    body_def.map = map;
    body_def.scale = static_cast<float>(o.scale);
    body_def.twist = {plain(o.velocity), plain(o.spin)};
    frm_body body = 0;
    session.check(frm_body_create(world, &body_def, &body));

    // One period of the map at the speed of the body's fastest corner, in twice as many ticks as the series has
    // samples.
    const Numbers corner{std::fmax(std::fabs(static_cast<double>(info.bounds_low.x)),
                                   std::fabs(static_cast<double>(info.bounds_high.x))),
                         std::fmax(std::fabs(static_cast<double>(info.bounds_low.y)),
                                   std::fabs(static_cast<double>(info.bounds_high.y))),
                         std::fmax(std::fabs(static_cast<double>(info.bounds_low.z)),
                                   std::fabs(static_cast<double>(info.bounds_high.z)))};
    const double speed = length(o.velocity) + length(o.spin) * length(corner) * o.scale;
    const double period = static_cast<double>(info.period) * static_cast<double>(info.base_speed) / speed * o.scale;
    const double seconds = o.seconds > 0 ? o.seconds : period;
    const double dt = std::fmin(0.1, std::fmax(1e-6, std::fmin(period, seconds) / (2.0 * info.samples)));
    const double ticks = std::fmax(1, std::round(seconds / dt));
    if (ticks > 1e8) {
        char text[120];
        std::snprintf(text, sizeof text,
                      "%.3g s at this speed would take more than 100 million ticks; give fewer --seconds", seconds);
        throw Failure(text);
    }

    Statistics force, torque;
    {
        ProgressBar bar("force");
        for (double n = 0; n < ticks; ++n) {
            session.check(frm_world_tick(world, static_cast<float>(dt)));
            frm_forces forces{};
            forces.struct_size = sizeof forces;
            session.check(frm_body_get_forces(body, &forces));
            force.add(forces.total.force);
            torque.add(forces.total.torque);
            if (std::fmod(n, 64) == 0 && !bar.update(n / ticks, "")) throw Failure("interrupted");
        }
    }
    frm_body_state state{};
    state.struct_size = sizeof state;
    session.check(frm_body_get_state(body, &state));
    const Numbers f = force.mean(), r = force.rms(), t = torque.mean();
    if (o.json) {
        nlohmann::ordered_json j{{"force_mean", f},
                                 {"force_rms", r},
                                 {"torque_mean", t},
                                 {"torque_rms", torque.rms()},
                                 {"seconds", ticks * dt},
                                 {"reynolds", state.reynolds},
                                 {"reynolds_baked", info.reynolds},
                                 {"reynolds_solved", info.reynolds_solved}};
        std::printf("%s\n", j.dump(2).c_str());
    } else {
        std::printf("force  %.6g, %.6g, %.6g N  (rms of the change %.3g, %.3g, %.3g)\n", f[0], f[1], f[2], r[0], r[1],
                    r[2]);
        std::printf("torque %.6g, %.6g, %.6g N m about the mesh's origin\n", t[0], t[1], t[2]);
        std::printf("over %.4g s; Reynolds number %.4g, the map was solved at %.4g\n", ticks * dt,
                    static_cast<double>(state.reynolds), static_cast<double>(info.reynolds_solved));
    }
}

}  // namespace

void add_force(CLI::App& app) {
    auto options = std::make_shared<Options>();
    Options& o = *options;
    CLI::App* command =
        app.add_subcommand("force",
                           "The force that a map gives for a body moving steadily through still water,\n"
                           "wholly submerged, without buoyancy.");
    command->footer("  frm force paddle.frm --velocity 0,1,0 --json");
    command->add_option("FILE", o.file, "a .frm map")->required()->check(not_empty())->type_name("");
    add_vector(*command, "--velocity", o.velocity, 1e4, "of the body, in the mesh's frame, m/s")->required();
    add_vector(*command, "--spin", o.spin, 1e4, "angular velocity about the mesh's origin, rad/s (default: none)");
    command->add_option("--seconds", o.seconds, "averaged over (default: one period of the map at this speed)")
        ->check(positive())
        ->type_name("S");
    command->add_option("--density", o.density, "of the fluid, kg/m^3 (default: the map's)")
        ->check(density_range())
        ->type_name("N");
    command->add_option("--viscosity", o.viscosity, "kinematic, m^2/s (default: the map's)")
        ->check(viscosity_range())
        ->type_name("N");
    command->add_option("--scale", o.scale, "of the object, 0.001 to 1000")
        ->check(number_within(1e-3, 1e3))
        ->type_name("N")
        ->capture_default_str();
    command->add_flag("--json", o.json, "JSON on standard output");
    command->callback([options] { run(*options); });
}

}  // namespace frm::cli
