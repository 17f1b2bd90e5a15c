#include "core/water/coupling.h"

#include <algorithm>
#include <cmath>

#include "core/kernels/kernels.h"

namespace frm {
namespace {

/// The part of a window's rectangle that lies in the water, in the window's cells.
Rect inside_water(const Footprint& footprint, const Field& water, const Rect& r) {
    return r.moved(footprint.i0(), footprint.j0())
        .clipped(water.def().nx, water.def().ny)
        .moved(-footprint.i0(), -footprint.j0());
}

/// Of a window: where its thickness is or was in the tick before.
Rect changed_cells(const Footprint& footprint) {
    Rect changed = footprint.wet();
    changed.include(footprint.wet_before());
    return changed;
}

std::size_t at(std::int32_t i, std::int32_t j, std::int32_t nx) {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
}

}  // namespace

void displace_water(Footprint& footprint, Field& water, float late) {
    if (footprint.first) return;
    if (!footprint.changed()) return;
    water.raise(footprint.rest_change());
    const Rect changed = changed_cells(footprint);
    const auto add = kernels().add_change_row;
    const auto raise = [&](Field& field, const Rect& r, std::int32_t di, std::int32_t dj) {
        field.wake(r.moved(di, dj));
        for (std::int32_t j = r.j0; j < r.j1; ++j)
            add(field.height_row(j + dj) + (r.i0 + di), footprint.thickness().row(j) + r.i0,
                footprint.thickness_before_row(j) + r.i0, r.i1 - r.i0);
        if (!(late > 0)) return;
        const std::int32_t n = footprint.size();
        field.push({footprint.thickness().data(), n, n, r, di, dj, late});
        field.push({footprint.thickness_before_row(0), n, n, r, di, dj, -late});
    };
    raise(footprint.own, changed, 0, 0);
    if (const Rect r = inside_water(footprint, water, changed); !r.empty())
        raise(water, r, footprint.i0(), footprint.j0());
}

void withdraw_body(Footprint& footprint, Field& water) {
    const float share = footprint.deposited_share();
    water.raise(-footprint.rest_before() * static_cast<double>(share));
    const Rect r = inside_water(footprint, water, footprint.wet_before());
    if (r.empty()) return;
    water.wake(r.moved(footprint.i0(), footprint.j0()));
    for (std::int32_t j = r.j0; j < r.j1; ++j) {
        float* row = water.height_row(j + footprint.j0()) + footprint.i0();
        const float* before = footprint.thickness_before_row(j);
        for (std::int32_t i = r.i0; i < r.i1; ++i) row[i] -= before[i] * share;
    }
}

void force_velocity(Footprint& footprint, Field& water, const Vec3f& linear, const Vec3f& angular, float z) {
    const std::int32_t n = footprint.size();
    const float* thickness = footprint.thickness().data();
    // The spline spreads a thin body over three columns: those with a fifth of the largest thickness are inside.
    float largest = 0;
    const Rect& wet = footprint.wet();
    for (std::int32_t j = wet.j0; j < wet.j1; ++j)
        for (std::int32_t i = wet.i0; i < wet.i1; ++i) largest = std::max(largest, thickness[at(i, j, n)]);
    if (!(largest > 0)) return;
    const auto inside = [&](std::int32_t i, std::int32_t j) {
        return i >= 0 && j >= 0 && i < n && j < n && thickness[at(i, j, n)] >= 0.2f * largest;
    };
    const GridOrigin body = footprint.body_in_window();
    const float cell = water.def().cell;
    const auto local = [&](float i, std::int32_t base, float fraction) {
        return (i - static_cast<float>(base) - fraction) * cell;
    };

    const Rect r = inside_water(footprint, water, {wet.i0, wet.j0, wet.i1 + 1, wet.j1 + 1});
    water.wake(r.moved(footprint.i0(), footprint.j0()));
    footprint.own.wake(r);
    for (std::int32_t j = r.j0; j < r.j1; ++j) {
        for (std::int32_t i = r.i0; i < r.i1; ++i) {
            const std::int32_t wi = i + footprint.i0(), wj = j + footprint.j0();
            if (wi > 0 && (inside(i, j) || inside(i - 1, j))) {
                const float y = local(static_cast<float>(j) + 0.5f, body.j, body.y);
                float& u = water.velocity_x_row(wj)[wi];
                const float change = linear.x + angular.y * z - angular.z * y - u;
                u += change;
                footprint.own.velocity_x_row(j)[i] += change;
            }
            if (wj > 0 && (inside(i, j) || inside(i, j - 1))) {
                const float x = local(static_cast<float>(i) + 0.5f, body.i, body.x);
                float& v = water.velocity_y_row(wj)[wi];
                const float change = linear.y + angular.z * x - angular.x * z - v;
                v += change;
                footprint.own.velocity_y_row(j)[i] += change;
            }
        }
    }
}

Push push_on_water(const Footprint& footprint) {
    const std::int32_t n = footprint.size();
    return {footprint.pressure(), n, n, footprint.pressed(), footprint.i0(), footprint.j0(), footprint.push};
}

double energy_of_push(const Footprint& footprint, const Field& water, float dt) {
    const Rect r = inside_water(footprint, water, footprint.pressed());
    if (r.empty()) return 0;
    const std::int32_t i0 = r.i0 + footprint.i0(), j0 = r.j0 + footprint.j0();
    const float sum = kernels().pressed_divergence(
        footprint.pressure() + at(r.i0, r.j0, footprint.size()), footprint.size(), water.velocity_x_row(j0) + i0,
        water.velocity_y_row(j0) + i0, water.stride(), r.j1 - r.j0, r.i1 - r.i0);
    // dE = rho d sum of u . dt grad p / rho over the faces = -d dt sum of p div u over the cells.
    const FieldDef& def = water.def();
    return -static_cast<double>(sum) * (static_cast<double>(def.depth * def.cell) * static_cast<double>(dt));
}

double work_of_change(const Footprint& footprint, const Field& water, const Rect& around, float half_step,
                      float* heights) {
    const Rect r = inside_water(footprint, water, changed_cells(footprint));
    Rect where = around;
    where.include(r.moved(footprint.i0(), footprint.j0()));
    const FieldDef& def = water.def();
    water.heights_ahead(where, -half_step * def.depth / def.cell, 0, heights);
    if (r.empty()) return 0;
    return static_cast<double>(
        kernels().change_work(heights + (r.j0 + footprint.j0()) * water.stride() + (r.i0 + footprint.i0()),
                              water.stride(), footprint.thickness().row(r.j0) + r.i0,
                              footprint.thickness_before_row(r.j0) + r.i0, footprint.size(), r.j1 - r.j0, r.i1 - r.i0));
}

double take_energy(Footprint& footprint, Field& water, float pull, float density, double energy) {
    Rect where = changed_cells(footprint);
    where.include(footprint.pressed());
    const Rect r = inside_water(footprint, water, where);
    // The leapfrog's kinetic energy is of the velocities half a step before and half a step after the heights, u and
    // u - pull dh/dx; slowed to k u it is k^2 square - k cross.
    const FieldDef& def = water.def();
    const float slope = pull / def.cell;
    double square = 0, cross = 0;
    for (std::int32_t j = r.j0 + footprint.j0(); j < r.j1 + footprint.j0(); ++j) {
        const float *h = water.height_row(j), *below = water.height_row(std::max(j - 1, 0));
        const float *u = water.velocity_x_row(j), *v = water.velocity_y_row(j);
        for (std::int32_t i = r.i0 + footprint.i0(); i < r.i1 + footprint.i0(); ++i) {
            const float ahead = slope * (h[i] - h[std::max(i - 1, 0)]), up = slope * (h[i] - below[i]);
            const auto x = static_cast<double>(u[i]), y = static_cast<double>(v[i]);
            square += x * x + y * y;
            cross += x * static_cast<double>(ahead) + y * static_cast<double>(up);
        }
    }
    if (!(square > 0)) return 0;
    const double cell = static_cast<double>(def.cell);
    const double each = 0.5 * static_cast<double>(density * def.depth) * cell * cell;
    const double inside = cross * cross + 4 * square * (square - cross - energy / each);
    const double keep = std::clamp((cross + std::sqrt(std::max(inside, 0.0))) / (2 * square), 0.0, 1.0);
    if (!(keep < 1)) return 0;
    const auto scale = kernels().scale;
    for (std::int32_t j = r.j0; j < r.j1; ++j) {
        const std::int32_t wi = r.i0 + footprint.i0(), wj = j + footprint.j0();
        const std::ptrdiff_t count = r.i1 - r.i0;
        const auto factor = static_cast<float>(keep);
        scale(water.velocity_x_row(wj) + wi, count, factor);
        scale(water.velocity_y_row(wj) + wi, count, factor);
        scale(footprint.own.velocity_x_row(j) + r.i0, count, factor);
        scale(footprint.own.velocity_y_row(j) + r.i0, count, factor);
    }
    return each * ((square - cross) - (keep * keep * square - keep * cross));
}

void advance_own(Footprint& footprint, float dt, float gravity, std::uint32_t steps) {
    if (!footprint.active()) return;
    const std::int32_t n = footprint.size();
    const Push push{footprint.pressure(), n, n, footprint.pressed(), 0, 0, footprint.push};
    footprint.own.advance(dt, gravity, steps, &push, footprint.pressed().empty() ? 0 : 1, 1);
}

}  // namespace frm
