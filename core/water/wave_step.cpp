#include "core/water/wave_step.h"

#include <algorithm>
#include <cmath>

namespace frm {
namespace {

/// Below this many cells the threads cost more than they bring (measured with `frm bench`).
constexpr std::size_t threaded_cells = std::size_t{1} << 18;
constexpr std::int32_t layer_room = 64;
constexpr std::int32_t rows_a_band = 16;  ///< at least
/// Rows of that many steps, less than a megabyte for 2048 columns, stay in the second-level cache.
constexpr std::uint32_t steps_together = 8;
/// The fourth-order difference on a staggered grid: (27 d1 - d3) / 24.
constexpr float near_weight = 27.0f / 24, far_weight = 1.0f / 24;

/// The push's cells, in its own array. The gradient reaches one face beyond them; faces of either array's outer border
/// are not pushed.
Rect pushed(const Field& field, const Push& p) {
    return Rect{p.where.i0, p.where.j0, p.where.i1 + 1, p.where.j1 + 1}
        .clipped(p.columns, p.rows)
        .moved(p.di, p.dj)
        .clipped(field.def().nx, field.def().ny)
        .moved(-p.di, -p.dj);
}

void push_cells_row(Field& field, const Push& p, std::int32_t row) {
    const Rect r = pushed(field, p);
    const std::int32_t j = row - p.dj, i0 = std::max({r.i0, 1, 1 - p.di});
    if (j < r.j0 || j >= r.j1 || i0 >= r.i1) return;
    kernels().wave_push(field.velocity_x_row(row) + i0 + p.di, p.pressure + std::ptrdiff_t{j} * p.columns + i0, 1,
                        r.i1 - i0, p.factor / field.def().cell);
}

void push_faces_row(Field& field, const Push& p, std::int32_t row) {
    const Rect r = pushed(field, p);
    const std::int32_t j = row - p.dj;
    if (j < std::max({r.j0, 1, 1 - p.dj}) || j >= r.j1 || r.i0 >= r.i1) return;
    kernels().wave_push(field.velocity_y_row(row) + r.i0 + p.di, p.pressure + std::ptrdiff_t{j} * p.columns + r.i0,
                        p.columns, r.i1 - r.i0, p.factor / field.def().cell);
}

/// A row of heights, mirrored at the borders.
const float* mirrored(const Field& field, std::int32_t j) {
    const std::int32_t ny = field.def().ny;
    return field.height_row(j < 0 ? -1 - j : j >= ny ? 2 * ny - 1 - j : j);
}

/// Faces beyond the border, at fourth order: odd about the ones on it.
void mirror_faces(Field& field, std::int32_t out, std::int32_t edge, std::int32_t inner) {
    float* const x = field.velocity_y_row(out);
    const float *a = field.velocity_y_row(edge), *b = field.velocity_y_row(inner);
    for (std::int32_t i = 0; i < field.def().nx; ++i) x[i] = 2 * a[i] - b[i];
}

}  // namespace

WaveStep::WaveStep(Field& field, float dt, float gravity, const Push* pushes, std::size_t push_count)
    : field_(field), kernel_(kernels()), pushes_(pushes), push_count_(push_count), fourth_(field.def_.order == 4) {
    const FieldDef& def = field.def_;
    slope_ = dt * gravity / def.cell;
    divergence_ = dt * def.depth / def.cell;
    if (def.border != Border::absorbing) return;
    // At an open border the outermost face moves as a wave that leaves does: u = h sqrt(g / d) (Flather 1976).
    const float speed = std::sqrt(gravity * def.depth);
    outflow_ = speed / def.depth;
    if (def.border_cells == 0) return;
    // A layer in which height and velocity decay together (so that it does not reflect), the faster the nearer to the
    // border: rate r (1 - x / width)^2 with r so large that a wave that crosses it twice keeps exp(-5).
    damps_ = true;
    if (field.keeps_for_ == dt * speed) return;
    field.keeps_for_ = dt * speed;
    const std::int32_t width = def.border_cells;
    const float rate = 7.5f * speed / (static_cast<float>(width) * def.cell);
    float* const cells = field.keep_.data();
    float* const faces = cells + layer_room;
    float* const ends = faces + layer_room;
    const auto end = [&](const float* of) { return ends + (of - ends); };
    for (std::int32_t k = 0; k < width; ++k) {
        const auto keep = [&](float distance) {
            const float x = 1.0f - distance / static_cast<float>(width);
            return x > 0 ? 1.0f / (1.0f + dt * rate * x * x) : 1.0f;
        };
        const std::ptrdiff_t mirror = def.nx - 1 - k - field.damp_.right_at;
        cells[k] = end(field.damp_.cells_left)[k] = end(field.damp_.cells_right)[mirror] =
            keep(static_cast<float>(k) + 0.5f);
        faces[k] = end(field.damp_.faces_left)[k] = end(field.damp_.faces_right)[mirror + 1] =
            keep(static_cast<float>(k));
    }
}

void WaveStep::one(std::uint32_t threads) {
    const std::int32_t ny = field_.def_.ny;
    std::int32_t bands = 1;
    if (threads > 1 && field_.cells() >= threaded_cells)
        bands = std::min(static_cast<std::int32_t>(threads), ny / rows_a_band);
    if (bands <= 1) {
        together(1);
        return;
    }
    // The faces that the rows on both sides of a band's edge need are moved before all bands, and damped after them.
    const auto begin = [&](std::int32_t b) { return static_cast<std::int32_t>(std::int64_t{ny} * b / bands); };
    const std::int32_t around = lead() - 1;
#pragma omp parallel num_threads(static_cast <int>(bands))
    {
#pragma omp for schedule(static)
        for (std::int32_t b = 0; b < bands; ++b)
            for (std::int32_t m = std::max(0, begin(b) - around); m <= begin(b) + around; ++m) faces(m);
#pragma omp for schedule(static)
        for (std::int32_t b = 0; b < bands; ++b) {
            const std::int32_t end = b + 1 < bands ? begin(b + 1) - around : ny + 1;
            for (std::int32_t r = begin(b); r < begin(b + 1); ++r) row(r, {end, begin(b) + around + 1, end});
        }
#pragma omp for schedule(static)
        for (std::int32_t b = 0; b < bands; ++b)
            for (std::int32_t m = std::max(0, begin(b) - around); m <= begin(b) + around; ++m) damp_faces(m);
    }
}

void WaveStep::together(std::uint32_t steps) {
    const std::int32_t ny = field_.def_.ny, count = static_cast<std::int32_t>(steps);
    const Own all{ny + 1, 0, ny + 1};
    for (std::int32_t t = -lead(); t < ny + lag() * (count - 1); ++t) {
        for (std::int32_t s = 0; s < count; ++s) {
            const std::int32_t r = t - lag() * s;
            if (r < -lead()) break;
            if (r < 0)
                faces(r + lead());
            else if (r < ny)
                row(r, all);
        }
    }
}

void WaveStep::row(std::int32_t r, const Own& own) {
    const FieldDef& def = field_.def_;
    const std::int32_t m = r + lead();
    if (push_count_ > 0) push_rows(r, m < std::min(def.ny, own.faces_end) ? m : 0);
    if (m == def.ny && m < own.faces_end) faces(m);
    if (fourth_ && r == def.ny - 1) mirror_faces(field_, def.ny + 1, def.ny, def.ny - 1);
    move_row(r, 0, def.nx, m < std::min(def.ny, own.faces_end));
    if (!damps_) return;
    const auto own_faces = [&](std::int32_t face) {
        return face >= own.damp_begin && face < own.damp_end ? field_.velocity_y_row(face) : nullptr;
    };
    const auto damp_own = [&](std::int32_t face) {
        if (own_faces(face)) damp_faces(face);
    };
    const bool border_row = std::min(r, def.ny - 1 - r) < def.border_cells;
    if (!border_row) {
        const std::int32_t done = fourth_ ? r - 1 : r;
        kernel_.wave_damp(field_.height_row(r), field_.velocity_x_row(r), own_faces(done), field_.damp_);
        return;
    }
    const float across = field_.keep_[static_cast<std::size_t>(std::min(r, def.ny - 1 - r))];
    kernel_.scale(field_.height_row(r), def.nx, across);
    kernel_.scale(field_.velocity_x_row(r), def.nx + 1, across);
    kernel_.wave_damp(field_.height_row(r), field_.velocity_x_row(r), nullptr, field_.damp_);
    if (fourth_ && r > 0) damp_own(r - 1);
    if (!fourth_ || r == def.ny - 1) damp_own(r);
    if (r == def.ny - 1) damp_own(r + 1);
}

void WaveStep::push_rows(std::int32_t r, std::int32_t m) {
    for (std::size_t k = 0; k < push_count_; ++k) {
        push_cells_row(field_, pushes_[k], r);
        push_faces_row(field_, pushes_[k], m);
    }
}

void WaveStep::move_row(std::int32_t r, std::int32_t i0, std::int32_t i1, bool with_faces) {
    const FieldDef& def = field_.def_;
    float* const h = field_.height_row(r) + i0;
    const std::ptrdiff_t stride = field_.stride();
    const bool wall_left = i0 == 0, wall_right = i1 == def.nx;
    const float left = wall_left ? -outflow_ * h[0] : 0.0f;
    const float right = wall_right ? outflow_ * h[i1 - i0 - 1] : 0.0f;
    float* const u = field_.velocity_x_row(r) + i0;
    float* const v = field_.velocity_y_row(r) + i0;
    if (!fourth_) {
        kernel_.wave_row({h, u, v, v + stride, with_faces ? h + stride : nullptr, i1 - i0, left, right, wall_left},
                         slope_, divergence_);
        return;
    }
    kernel_.wave_row_4(
        {h, u, v - stride, v, v + stride, v + 2 * stride, h + stride, h + 2 * stride,
         with_faces ? mirrored(field_, r + 3) + i0 : nullptr, i1 - i0, left, right, wall_left, wall_right},
        slope_ * near_weight, slope_ * far_weight, divergence_ * near_weight, divergence_ * far_weight);
}

void WaveStep::faces(std::int32_t m) {
    const FieldDef& def = field_.def_;
    float* const v = field_.velocity_y_row(m);
    if (m == 0 || m == def.ny) {
        if (def.border == Border::absorbing)
            kernel_.wave_outflow(v, field_.height_row(m == 0 ? 0 : m - 1), def.nx, m == 0 ? -outflow_ : outflow_);
        return;
    }
    for (std::size_t k = 0; k < push_count_; ++k) push_faces_row(field_, pushes_[k], m);
    if (!fourth_) {
        kernel_.wave_faces(v, field_.height_row(m), field_.height_row(m - 1), def.nx, slope_);
        return;
    }
    kernel_.wave_faces_4(v, field_.height_row(m), field_.height_row(m - 1), mirrored(field_, m + 1),
                         mirrored(field_, m - 2), def.nx, slope_ * near_weight, slope_ * far_weight);
    if (m == 1) mirror_faces(field_, -1, 0, 1);
}

void WaveStep::damp_faces(std::int32_t m) {
    if (!damps_) return;
    const FieldDef& def = field_.def_;
    const std::int32_t from_border = std::min(m, def.ny - m);
    if (from_border < def.border_cells)
        kernel_.scale(field_.velocity_y_row(m), def.nx, field_.keep_[static_cast<std::size_t>(layer_room + from_border)]);
    kernel_.wave_damp(nullptr, nullptr, field_.velocity_y_row(m), field_.damp_);
}

void Field::advance(float dt, float gravity, std::uint32_t steps, const Push* pushes, std::size_t push_count,
                    std::uint32_t threads) {
    WaveStep step(*this, dt, gravity, pushes, push_count);
    if (threads > 1 && cells() >= threaded_cells) {
        for (std::uint32_t s = 0; s < steps; ++s) step.one(threads);
        return;
    }
    for (; steps > 0; steps -= std::min(steps, steps_together)) step.together(std::min(steps, steps_together));
}

void Field::push(const Push& push) {
    const Rect r = pushed(*this, push);
    for (std::int32_t j = r.j0; j < r.j1; ++j) {
        push_cells_row(*this, push, j + push.dj);
        push_faces_row(*this, push, j + push.dj);
    }
}

}  // namespace frm
