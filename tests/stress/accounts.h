// Where the water's energy comes from: tick by tick, what a body's displacement gives it and what the rest of the tick does.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/worlds.h"

namespace frm::test {

/// The energy that leapfrog steps of `step` s keep in a closed basin, J: heights, and the product of the velocities half a
/// step before and half a step after them.
inline double kept_energy(const FieldDef& def, const std::vector<double>& h, const std::vector<double>& u,
                          const std::vector<double>& v, const Fluid& fluid, double step) {
    const auto nx = static_cast<std::size_t>(def.nx), ny = static_cast<std::size_t>(def.ny);
    const double cell = static_cast<double>(def.cell), pull = step * static_cast<double>(fluid.gravity) / cell;
    double potential = 0, kinetic = 0;
    for (std::size_t j = 0; j < ny; ++j)
        for (std::size_t i = 0; i < nx; ++i) {
            const std::size_t k = j * nx + i;
            potential += h[k] * h[k];
            if (i > 0) kinetic += u[k] * (u[k] - pull * (h[k] - h[k - 1]));
            if (j > 0) kinetic += v[k] * (v[k] - pull * (h[k] - h[k - nx]));
        }
    return 0.5 * static_cast<double>(fluid.density) * cell * cell *
           (static_cast<double>(fluid.gravity) * potential + static_cast<double>(def.depth) * kinetic);
}

/// For one body alone in a closed basin whose water is stepped in every tick, second order in space.
class Accounts {
public:
    double laid = 0;    ///< J that the water has from what the body displaces
    double below = 0;   ///< J that it would have, were that laid where the body is and not spread with depth
    double apart = 0;   ///< J that the two can differ by, as high and steep as the water was
    double pushed = 0;  ///< J that it has from all the rest of the ticks: pushes, and what steps make, which is nothing
    double waves = 0;   ///< J that it has now

    Accounts(const World& world, const Water& water, const Body& body)
        : world_(world), water_(water), body_(body), unspread_(body.def, 0, memory()) {
        const double volume = body.def.map->shape.volume;
        unspread_.footprint.emplace(water.def().field, body.radius(), volume, memory());
        unspread_.elements.emplace(*body.def.map, water.def().field.cell, unspread_.footprint->levels(), memory());
    }

    double energy_now(double step) {
        read(h_, u_, v_);
        return energy(h_, u_, v_, step);
    }
    void before_tick() {
        read(h_, u_, v_);
        first_ = body_.footprint->first;
        thickness(*body_.footprint, before_);
    }
    void after_tick(double dt) {
        thickness(*body_.footprint, now_);
        lay_unspread();
        if (first_) before_ = now_, before_0_ = now_0_;  // a body that is put into the water makes no splash
        read(h_now_, u_now_, v_now_);
        const double level = static_cast<double>(water_.field.level());
        std::vector<double> with(h_);
        for (std::size_t k = 0; k < with.size(); ++k) with[k] += now_[k] - before_[k] + level - level_;
        const double step = dt / world_.substeps();
        compare(with, step);
        const double was = energy(h_, u_, v_, step), then = energy(with, u_, v_, step);
        waves = energy(h_now_, u_now_, v_now_, step);
        laid += then - was;
        pushed += waves - then;
        level_ = level;
    }

private:
    double energy(const std::vector<double>& h, const std::vector<double>& u, const std::vector<double>& v,
                  double step) const {
        return kept_energy(water_.def().field, h, u, v, world_.def().fluid, step);
    }
    void read(std::vector<double>& h, std::vector<double>& u, std::vector<double>& v) const {
        const Field& f = water_.field;
        h.clear(), u.clear(), v.clear();
        for (std::int32_t j = 0; j < f.def().ny; ++j)
            for (std::int32_t i = 0; i < f.def().nx; ++i) {
                h.push_back(static_cast<double>(f.height_row(j)[i]) + static_cast<double>(f.level()));
                u.push_back(static_cast<double>(f.velocity_x_row(j)[i]));
                v.push_back(static_cast<double>(f.velocity_y_row(j)[i]));
            }
    }
    /// What the body has laid on the water, by the water's cells.
    void thickness(const Footprint& f, std::vector<double>& out) const {
        const FieldDef& def = water_.def().field;
        out.assign(static_cast<std::size_t>(def.nx) * static_cast<std::size_t>(def.ny), 0.0);
        const Rect r = f.wet_before().moved(f.i0(), f.j0()).clipped(def.nx, def.ny);
        for (std::int32_t j = r.j0; j < r.j1; ++j)
            for (std::int32_t i = r.i0; i < r.i1; ++i)
                out[static_cast<std::size_t>(j) * static_cast<std::size_t>(def.nx) + static_cast<std::size_t>(i)] =
                    static_cast<double>(f.thickness_before_row(j - f.j0())[i - f.i0()]);
    }

    void lay_unspread() {
        unspread_.def.pose = body_.def.pose;
        unspread_.rotation = body_.rotation;
        Footprint& f = *unspread_.footprint;
        const Vec3d& at = body_.def.pose.position;
        const GridOrigin origin = water_.origin_at(at.x, at.y);
        f.begin(origin.i, origin.j, origin, nullptr);
        lay_displacement(unspread_, static_cast<float>(-at.z), false);
        f.end();
        before_0_.swap(now_0_);
        thickness(f, now_0_);
    }
    /// What is laid works against the mean of the heights that it meets, half a step before and half a step after; the
    /// difference of two layings of one volume is at most that volume from the highest to the lowest of them.
    void compare(const std::vector<double>& with, double step) {
        const FieldDef& def = water_.def().field;
        const auto nx = static_cast<std::size_t>(def.nx), ny = static_cast<std::size_t>(def.ny);
        const double cell = static_cast<double>(def.cell), fall = 0.5 * step * static_cast<double>(def.depth) / cell;
        const double weight =
            static_cast<double>(world_.def().fluid.density * world_.def().fluid.gravity) * cell * cell;
        double low = 1e30, high = -1e30, moved = 0;
        for (std::size_t j = 0; j < ny; ++j)
            for (std::size_t i = 0; i < nx; ++i) {
                const std::size_t k = j * nx + i;
                const double right = i + 1 < nx ? u_[k + 1] : 0.0, above = j + 1 < ny ? v_[k + nx] : 0.0;
                const double h = 0.5 * (h_[k] + with[k]) + fall * (right - u_[k] + above - v_[k]);
                const double change = now_[k] - before_[k], change_0 = now_0_[k] - before_0_[k];
                below += weight * h * change_0;
                moved += std::fabs(change - change_0);
                if (change != 0 || change_0 != 0) low = std::min(low, h), high = std::max(high, h);
            }
        if (moved > 0) apart += 0.5 * weight * moved * (high - low);
    }

    const World& world_;
    const Water& water_;
    const Body& body_;
    Body unspread_;  ///< in no world
    std::vector<double> h_, u_, v_, h_now_, u_now_, v_now_, before_, now_, before_0_, now_0_;
    double level_ = 0;
    bool first_ = false;
};

}  // namespace frm::test
