// A body that floats: moved as a host would move it, by the forces of a tick and semi-implicit Euler.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "core/body/coefficients.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

namespace frm::test {

inline double water_energy(const Field& f, const Fluid& fluid) {
    double potential = 0, kinetic = 0;
    const std::int32_t nx = f.def().nx, ny = f.def().ny;
    for (std::int32_t j = 0; j < ny; ++j) {
        for (std::int32_t i = 0; i < nx; ++i) {
            const auto h = static_cast<double>(f.height_row(j)[i]) + static_cast<double>(f.level());
            potential += h * h;
        }
        for (std::int32_t i = 0; i <= nx; ++i)
            kinetic += std::pow(static_cast<double>(f.velocity_x_row(j)[i]), 2) * (i == 0 || i == nx ? 0.5 : 1.0);
    }
    for (std::int32_t j = 0; j <= ny; ++j)
        for (std::int32_t i = 0; i < nx; ++i)
            kinetic += std::pow(static_cast<double>(f.velocity_y_row(j)[i]), 2) * (j == 0 || j == ny ? 0.5 : 1.0);
    const auto cell = static_cast<double>(f.def().cell);
    return 0.5 * static_cast<double>(fluid.density) * cell * cell *
           (static_cast<double>(fluid.gravity) * potential + static_cast<double>(f.def().depth) * kinetic);
}

inline float highest(const Field& f) {
    float most = 0;
    for (std::int32_t j = 0; j < f.def().ny; ++j)
        for (std::int32_t i = 0; i < f.def().nx; ++i) most = std::max(most, std::fabs(f.height_row(j)[i]));
    return most;
}

/// A box of uniform density, its origin its centre.
struct FloatingBox {
    Vec3d size;
    double mass = 0;
    Pose pose;
    Vec3d velocity, spin;  ///< world axes
    Body* body = nullptr;
    float wet_share = 0;  ///< of the last step

    FloatingBox(World& world, const std::shared_ptr<const Map>& map, const Vec3d& edges, double ratio, const Pose& at)
        : size(edges),
          mass(ratio * static_cast<double>(world.def().fluid.density) * edges.x * edges.y * edges.z),
          pose(at) {
        BodyDef def = body_of(map, at.position, at.rotation);
        def.mass = static_cast<float>(mass);
        body = &world.create_body(def);
    }

    Vec3d inertia() const {  ///< about the box's own axes
        const Vec3d s(size.x * size.x, size.y * size.y, size.z * size.z);
        return Vec3d(s.y + s.z, s.z + s.x, s.x + s.y) * (mass / 12);
    }

    void tell(World& world) const { world.set_motion(*body, pose, {Vec3f(velocity), Vec3f(spin)}); }

    /// v += dt F / m, then x += dt v.
    void step(double dt) { advance(dt, nullptr); }

    /// With what the water adds: (M + added mass + dt damping) dv = dt F - grown added mass * v.
    void step_with(double dt, const Fluid& fluid) {
        const Coefficients c = coefficients_of(*body, fluid);
        advance(dt, &c);
        wet_share = c.wet_share;
    }

    double energy() const {
        const Rotation<float> r(pose.rotation);
        const Vec3d o(r.to_body(Vec3f(spin))), i = inertia();
        return 0.5 * mass * dot(velocity, velocity) + 0.5 * (i.x * o.x * o.x + i.y * o.y * o.y + i.z * o.z * o.z);
    }

private:
    void advance(double dt, const Coefficients* c) {
        const Rotation<float> r(pose.rotation);
        const Vec3d o(r.to_body(Vec3f(spin))), i = inertia();
        const Vec3d force(body->forces.total.force);
        const Vec3d torque = Vec3d(body->forces.total.torque) -
                             Vec3d(r.to_world(Vec3f(cross(o, Vec3d(i.x * o.x, i.y * o.y, i.z * o.z)))));
        double a[6][6] = {}, b[6];
        const Vec3d row[3] = {Vec3d(r.row0), Vec3d(r.row1), Vec3d(r.row2)};
        for (int p = 0; p < 3; ++p) {
            a[p][p] = mass;
            b[p] = dt * force[p], b[3 + p] = dt * torque[p];
            for (int q = 0; q < 3; ++q)
                for (int k = 0; k < 3; ++k) a[3 + p][3 + q] += row[p][k] * i[k] * row[q][k];
        }
        // What gets wet takes its momentum from the body (von Karman 1929); what gets dry leaves with what it has.
        const double v[6] = {velocity.x, velocity.y, velocity.z, spin.x, spin.y, spin.z};
        const double grown = c && c->wet_share > wet_share ? 1 - static_cast<double>(wet_share / c->wet_share) : 0;
        for (std::size_t p = 0; c && p < 6; ++p)
            for (std::size_t q = 0; q < 6; ++q) {
                a[p][q] += c->added_mass[6 * p + q] + dt * c->damping[6 * p + q];
                b[p] -= grown * c->added_mass[6 * p + q] * v[q];
            }
        solve(a, b);
        velocity += Vec3d(b[0], b[1], b[2]);
        spin += Vec3d(b[3], b[4], b[5]);
        pose.position += velocity * dt;
        const double angle = length(spin) * dt;
        if (!(angle > 0)) return;
        const Quat<float> turn = turned(spin, angle) * pose.rotation;
        const float l = std::sqrt(turn.x * turn.x + turn.y * turn.y + turn.z * turn.z + turn.w * turn.w);
        pose.rotation = {turn.x / l, turn.y / l, turn.z / l, turn.w / l};
    }

    /// By Gauss; the matrix is symmetric and positive definite, so that no row need be exchanged.
    static void solve(double (&a)[6][6], double (&b)[6]) {
        for (int p = 0; p < 6; ++p)
            for (int q = p + 1; q < 6; ++q) {
                const double f = a[q][p] / a[p][p];
                for (int k = p; k < 6; ++k) a[q][k] -= f * a[p][k];
                b[q] -= f * b[p];
            }
        for (int p = 5; p >= 0; --p) {
            for (int q = p + 1; q < 6; ++q) b[p] -= a[p][q] * b[q];
            b[p] /= a[p][p];
        }
    }
};

/// A box of edges 1, 1, `flat`, with about the added mass of a cube (docs/added-mass.md: 0.64 rho V).
inline std::shared_ptr<const Map> box_map(double edge, double flat) {
    Map map = bake::formula_map(fine_box({edge, edge, flat * edge}, edge / 4), 18, 2, 32);
    map.has_added_mass = true;
    const double displaced = 1000 * flat * edge * edge * edge;
    for (std::size_t i = 0; i < 6; ++i) map.added_mass[7 * i] = displaced * (i < 3 ? 0.64 : 0.05 * edge * edge);
    map.complete();
    return std::make_shared<Map>(std::move(map));
}

struct FloatingScene {
    double edge = 0.4, flat = 0.6, ratio = 0.5;
    double dt = 0.002, seconds = 30;
    Border border = Border::reflecting;
    std::uint32_t skip = skip_default;
    std::int32_t cells = 32;
    double cell = 0.05, depth = 0.8;
    double above = 0.3;  ///< where it begins, above where it floats, of its edge
    double tilt = 0.2;
    bool with = true;                           ///< what the interface gives for a light body
    bool guided = false;                        ///< it only heaves
    std::function<double(std::size_t)> tick{};  ///< s, of tick n; none: all are dt long
};

struct FloatingOutcome {
    std::vector<double>
        energy;         ///< the largest kinetic energy of body and energy of water in each quarter, of m g edge
    double speed = 0;   ///< the largest in the last quarter, m/s, of any point of it
    double height = 0;  ///< at the end, of the edge, above where it floats
};

inline FloatingOutcome let_float(const FloatingScene& s) {
    WorldDef def;
    def.skip = s.skip;
    World world = world_of(def);
    Water& water =
        world.create_water(water_of(s.cells, static_cast<float>(s.cell), static_cast<float>(s.depth), s.border, 0));
    const double rest = s.edge * s.flat * (0.5 - s.ratio);
    FloatingBox box(world, box_map(s.edge, s.flat), {s.edge, s.edge, s.flat * s.edge}, s.ratio,
                    {{0.3 * s.edge, 0.1 * s.edge, rest + s.above * s.edge}, turned({1, 0.3, 0.2}, s.tilt)});
    FloatingOutcome out;
    out.energy.assign(4, 0.0);
    double share = 0;  // of the time
    for (std::size_t n = 0; share < 1; ++n) {
        const double dt = s.tick ? s.tick(n) : s.dt;
        box.tell(world);
        REQUIRE(world.tick(static_cast<float>(dt)));
        if (s.with)
            box.step_with(dt, def.fluid);
        else
            box.step(dt);
        REQUIRE(length(box.velocity) < 100);
        // On a pole, so that it does not leave a small basin.
        box.velocity.x = box.velocity.y = 0;
        box.pose.position.x = 0.3 * s.edge, box.pose.position.y = 0.1 * s.edge;
        if (s.guided) box.spin = {};
        double& most = out.energy[static_cast<std::size_t>(4 * share)];
        if (n % 4 == 0)
            most =
                std::max(most, (box.energy() + water_energy(water.field, def.fluid)) / (box.mass * 9.80665 * s.edge));
        if (share > 0.75) out.speed = std::max(out.speed, length(box.velocity) + s.edge * length(box.spin));
        share = s.tick ? share + dt / s.seconds : static_cast<double>(n + 1) * dt / s.seconds;
    }
    out.height = (box.pose.position.z - rest) / s.edge;
    return out;
}

}  // namespace frm::test
