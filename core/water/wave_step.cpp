#include "core/water/wave_step.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/floating_point.h"

namespace frm {
namespace {

/// Below this many cells the threads cost more than they bring (measured with `frm bench`).
constexpr std::size_t threaded_cells = std::size_t{1} << 18;
constexpr std::int32_t layer_room = 64;
constexpr std::int32_t rows_a_band = 16;  ///< at least
/// Rows of that many steps, less than a megabyte for 2048 columns, stay in the second-level cache. It pays where the
/// water does not fit into the last level (measured: 512 and 1024 square are faster step by step).
constexpr std::uint32_t steps_together = 8;
/// That each step does before the next: the row above the one in hand is still in the first-level cache (measured: one
/// row at a time takes a quarter longer).
constexpr std::int32_t rows_a_turn = 8;
/// The fourth-order difference on a staggered grid: (27 d1 - d3) / 24.
constexpr float near_weight = 27.0f / 24, far_weight = 1.0f / 24;

void prefetch([[maybe_unused]] const float* x) {
#if defined(__GNUC__)
    __builtin_prefetch(x, 1, 2);
#endif
}

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
    // A layer in which height and velocity decay together, the faster the nearer to the border, by (1 - x / width)^2.
    // Weakly: a wave straight through it and back keeps exp(-2/3). What comes in at an angle, or is longer than the
    // layer, such a layer throws back the more the stronger it is (tests/physics/test_wave_accuracy.cpp).
    damps_ = true;
    if (field.keeps_for_ == dt * speed) return;
    field.keeps_for_ = dt * speed;
    const std::int32_t width = def.border_cells;
    const float rate = speed / (static_cast<float>(width) * def.cell);
    float *const cells = field.keep_.data(), *const faces = cells + layer_room;
    const auto at = [&](const float* end) { return field.ends_ + (end - field.ends_); };
    for (std::int32_t k = 0; k < width; ++k) {
        const auto keep = [&](float distance) {
            const float x = 1.0f - distance / static_cast<float>(width);
            return x > 0 ? 1.0f / (1.0f + dt * rate * x * x) : 1.0f;
        };
        const std::ptrdiff_t mirror = def.nx - 1 - k - field.damp_.right_at;
        cells[k] = keep(static_cast<float>(k) + 0.5f);
        faces[k] = keep(static_cast<float>(k));
        at(field.damp_.cells_left)[k] = at(field.damp_.cells_right)[mirror] = cells[k];
        at(field.damp_.faces_left)[k] = at(field.damp_.faces_right)[mirror + 1] = faces[k];
    }
}

void WaveStep::one(std::uint32_t threads) {
    const std::int32_t ny = field_.def_.ny;
    std::int32_t bands = 1;
    if (threads > 1) bands = std::min(static_cast<std::int32_t>(threads), ny / rows_a_band);
    if (bands <= 1) {
        together(1);
        return;
    }
    // The faces that the rows on both sides of a band's edge need are moved before all bands, and damped after them.
    const auto begin = [&](std::int32_t b) { return static_cast<std::int32_t>(std::int64_t{ny} * b / bands); };
    const std::int32_t around = lead() - 1;
#pragma omp parallel num_threads(static_cast <int>(bands))
    {
        // The threads are the process's: a host may have had them before, in modes of its own.
        const FloatingPointGuard modes;
#pragma omp for schedule(static)
        for (std::int32_t b = 0; b < bands; ++b)
            for (std::int32_t m = std::max(0, begin(b) - around); m <= begin(b) + around; ++m) faces(m);
#pragma omp for schedule(static)
        for (std::int32_t b = 0; b < bands; ++b) {
            const std::int32_t end = b + 1 < bands ? begin(b + 1) - around : ny + 1;
            rows(begin(b), begin(b + 1), {end, begin(b) + around + 1, end});
        }
#pragma omp for schedule(static)
        for (std::int32_t b = 0; b < bands; ++b)
            for (std::int32_t m = std::max(0, begin(b) - around); m <= begin(b) + around; ++m) damp_faces(m);
    }
}

void WaveStep::together(std::uint32_t steps) {
    const std::int32_t ny = field_.def_.ny, count = static_cast<std::int32_t>(steps);
    const Own all{ny + 1, 0, ny + 1};
    if (count == 1) {
        rows(-lead(), ny, all);
        return;
    }
    for (std::int32_t t = -lead(); t < ny + lag() * (count - 1); t += rows_a_turn) {
        for (std::int32_t s = 0; s < count; ++s) {
            const std::int32_t r = t - lag() * s;
            // Each step of this turn asks for its part of the rows that the first step will soon come to: the processor
            // itself does not see that coming while all others go through older rows.
            for (std::int32_t k = 0; k < rows_a_turn; ++k) fetch(t + rows_a_turn + 2 + k, s, count);
            if (r + rows_a_turn <= -lead()) break;
            rows(std::max(r, -lead()), std::min(r + rows_a_turn, ny), all);
        }
    }
}

void WaveStep::fetch(std::int32_t r, std::int32_t part, std::int32_t parts) const {
    constexpr std::ptrdiff_t line = 16;  // floats
    const Block* const block = r < field_.def_.ny ? field_.tiles_.block_of(r) : nullptr;
    if (!block) return;
    const std::ptrdiff_t lines = (field_.def_.nx + line) / line;
    for (std::ptrdiff_t k = lines * part / parts; k < lines * (part + 1) / parts; ++k) {
        prefetch(field_.height_row(r) + k * line);
        prefetch(field_.velocity_x_row(r) + k * line);
        prefetch(field_.velocity_y_row(r) + k * line);
    }
}

// Rows whose turns are alike, inside a block and off the layer's rows, go to the kernel in one call.
void WaveStep::rows(std::int32_t first, std::int32_t end, const Own& own) {
    const FieldDef& def = field_.def_;
    const std::int32_t width = damps_ ? def.border_cells : 0, behind = fourth_ && damps_ ? 1 : 0;
    for (std::int32_t r = first; r < end;) {
        const Block* block = r >= 0 ? field_.tiles_.block_of(r) : nullptr;
        if (!block) {
            turn(r++, own);
            // To where the next block's first faces have their turn.
            const auto& blocks = field_.tiles_.blocks();
            const auto next = std::find_if(blocks.begin(), blocks.end(), [&](const Block& b) { return b.r0 >= r; });
            r = next == blocks.end() ? end : std::max(r, next->r0 - lead());
            continue;
        }
        const std::int32_t like_begin = std::max({block->r0, width, own.damp_begin}) + behind;
        const std::int32_t like_end =
            std::min({end, def.ny - width, def.ny - lag() + 1, std::min(block->r1, own.faces_end) - lead()});
        if (push_count_ > 0 || r < like_begin || r >= like_end) {
            turn(r++, own);
            continue;
        }
        move(*block, r, like_end - r, true, damps_ ? &field_.damp_ : nullptr);
        r = like_end;
    }
}

void WaveStep::turn(std::int32_t r, const Own& own) {
    const FieldDef& def = field_.def_;
    const std::int32_t m = r + lead();
    const Block* const block = r >= 0 ? field_.tiles_.block_of(r) : nullptr;
    const bool with_faces = block && m < std::min(block->r1, own.faces_end);
    if (!with_faces && m <= def.ny && m < own.faces_end) faces(m);
    if (block) {
        for (std::size_t k = 0; k < push_count_; ++k) {
            push_cells_row(field_, pushes_[k], r);
            if (with_faces) push_faces_row(field_, pushes_[k], m);
        }
        if (fourth_ && r == def.ny - 1) mirror_faces(field_, def.ny + 1, def.ny, def.ny - 1);
        move(*block, r, 1, with_faces, nullptr);
    }
    if (!damps_ || r < 0) return;
    if (block) damp_row(*block, r);
    const auto damp_own = [&](std::int32_t face) {
        if (face >= own.damp_begin && face < own.damp_end) damp_faces(face);
    };
    if (fourth_ && r > 0) damp_own(r - 1);
    if (!fourth_ || r == def.ny - 1) damp_own(r);
    if (r == def.ny - 1) damp_own(r + 1);
}

void WaveStep::move(const Block& block, std::int32_t r, std::int32_t rows, bool with_faces, const WaveDamp* damp) {
    const FieldDef& def = field_.def_;
    const bool third_row_is_missing = fourth_ && with_faces && r + 3 >= def.ny;
    for (const Span* span = block.begin; span != block.end; ++span) {
        const std::int32_t i0 = span->i0, i1 = span->i1;
        WaveRows w;
        w.height = field_.height_row(r) + i0;
        w.velocity_x = field_.velocity_x_row(r) + i0;
        w.velocity_y = field_.velocity_y_row(r) + i0;
        w.stride = field_.stride();
        w.rows = rows;
        w.count = i1 - i0;
        w.with_faces = with_faces;
        w.wall_left = i0 == 0;
        w.wall_right = i1 == def.nx;
        w.outflow = outflow_;
        w.height_3 = third_row_is_missing ? mirrored(field_, r + 3) + i0 : nullptr;
        w.damp = damp;
        w.damp_left = span == block.begin && i0 < field_.damp_.left;
        w.damp_right = span + 1 == block.end && i1 > field_.damp_.right_at;
        w.first_column = i0;
        if (fourth_)
            kernel_.wave_rows_4(w, slope_ * near_weight, slope_ * far_weight, divergence_ * near_weight,
                                divergence_ * far_weight);
        else
            kernel_.wave_rows(w, slope_, divergence_);
    }
}

const Block* WaveStep::block_of_faces(std::int32_t m) const {
    return field_.tiles_.block_of(std::min(m, field_.def_.ny - 1));
}

void WaveStep::faces(std::int32_t m) {
    const FieldDef& def = field_.def_;
    const Block* const block = block_of_faces(m);
    if (!block) return;
    if (m > 0 && m < def.ny)
        for (std::size_t k = 0; k < push_count_; ++k) push_faces_row(field_, pushes_[k], m);
    for (const Span* span = block->begin; span != block->end; ++span) {
        const std::int32_t i0 = span->i0, count = span->i1 - i0;
        float* const v = field_.velocity_y_row(m) + i0;
        const auto h = [&](std::int32_t j) { return mirrored(field_, j) + i0; };
        if (m == 0 || m == def.ny) {
            if (def.border == Border::absorbing)
                kernel_.wave_outflow(v, h(m == 0 ? 0 : m - 1), count, m == 0 ? -outflow_ : outflow_);
        } else if (fourth_) {
            kernel_.wave_faces_4(v, h(m), h(m - 1), h(m + 1), h(m - 2), count, slope_ * near_weight,
                                 slope_ * far_weight);
        } else {
            kernel_.wave_faces(v, h(m), h(m - 1), count, slope_);
        }
    }
    if (fourth_ && m == 1) mirror_faces(field_, -1, 0, 1);
}

void WaveStep::damp_row(const Block& block, std::int32_t r) {
    const std::int32_t from_border = std::min(r, field_.def_.ny - 1 - r);
    const float across =
        from_border < field_.def_.border_cells ? field_.keep_[static_cast<std::size_t>(from_border)] : 1.0f;
    damp(block, field_.height_row(r), false, across);
    damp(block, field_.velocity_x_row(r), true, across);
}

void WaveStep::damp_faces(std::int32_t m) {
    const Block* const block = block_of_faces(m);
    if (!damps_ || !block) return;
    const std::int32_t from_border = std::min(m, field_.def_.ny - m);
    damp(*block, field_.velocity_y_row(m), false,
         from_border < field_.def_.border_cells ? field_.keep_[static_cast<std::size_t>(layer_room + from_border)]
                                                : 1.0f);
}

void WaveStep::damp(const Block& block, float* x, bool along, float across) {
    const WaveDamp& d = field_.damp_;
    if (across != 1.0f)
        for (const Span* span = block.begin; span != block.end; ++span)
            kernel_.scale(x + span->i0, span->i1 - span->i0 + (along && span->i1 == field_.def_.nx), across);
    kernel_.scale_ends(x, along ? d.faces_left : d.cells_left, along ? d.faces_right : d.cells_right, d);
}

void Field::look_for_calm(float gravity) {
    const float still = def_.calm > 0 ? def_.calm : 1e-6f * std::min(def_.depth, 20 * def_.cell);
    // The velocity of a wave of that height.
    const float slow = still * std::sqrt(gravity / def_.depth);
    const Kernels& kernel = kernels();
    const auto each = [&](const Rect& c, const auto& use) {
        const std::int32_t last_column = c.i1 == def_.nx, last_row = c.j1 == def_.ny;
        return use(height_row(c.j0) + c.i0, c.j1 - c.j0, c.i1 - c.i0, still) ||
               use(velocity_x_row(c.j0) + c.i0, c.j1 - c.j0, c.i1 - c.i0 + last_column, slow) ||
               use(velocity_y_row(c.j0) + c.i0, c.j1 - c.j0 + last_row, c.i1 - c.i0, slow);
    };
    tiles_.look(
        [&](const Rect& c, float share) {
            return each(c, [&](const float* x, std::int32_t rows, std::int32_t count, float limit) {
                return kernel.any_above(x, stride_, rows, count, share * limit);
            });
        },
        [&](const Rect& c) {
            each(c, [&](float* x, std::int32_t rows, std::int32_t count, float) {
                for (std::int32_t j = 0; j < rows; ++j) std::fill_n(x + j * stride_, count, 0.0f);
                return false;
            });
        });
}

void Field::look_for_high_waves(std::uint32_t steps) {
    steps_unseen_ += steps;
    if (steps_unseen_ < CalmTiles::interval) return;
    steps_unseen_ = 0;
    const auto any_above = [&](float limit) {
        for (const Block& block : tiles_.blocks())
            for (const Span* s = block.begin; s != block.end; ++s)
                if (kernels().any_above(height_row(block.r0) + s->i0, stride_, block.r1 - block.r0, s->i1 - s->i0,
                                        limit))
                    return true;
        return false;
    };
    high_ = any_above(def_.depth - std::fabs(level()));
    finite_ = !high_ || !any_above(std::numeric_limits<float>::max());
}

void Field::advance(float dt, float gravity, std::uint32_t steps, const Push* pushes, std::size_t push_count,
                    std::uint32_t threads) {
    for (std::size_t k = 0; k < push_count; ++k) {
        const Rect r = pushed(*this, pushes[k]).moved(pushes[k].di, pushes[k].dj);
        wake(r);
    }
    while (steps > 0) {
        const bool threaded = threads > 1 && active_cells() >= threaded_cells;
        const std::uint32_t now =
            std::min({steps, tiles_.steps_left(), threaded || active_cells() < together_from_ ? 1 : steps_together});
        if (now == 1)
            for (std::size_t k = 0; k < push_count; ++k) push(pushes[k]);
        WaveStep step(*this, dt, gravity, pushes, now == 1 ? 0 : push_count);
        if (threaded)
            step.one(threads);
        else
            step.together(now);
        tiles_.count(now);
        if (tiles_.due()) look_for_calm(gravity);
        look_for_high_waves(now);
        steps -= now;
    }
}

void Field::push(const Push& push) {
    const Rect r = pushed(*this, push);
    wake(r.moved(push.di, push.dj));
    // At a border, one row of cells and one column of faces have a neighbour on one side only.
    const std::int32_t i0 = std::max({r.i0, 1, 1 - push.di}), j0 = std::max({r.j0, 1, 1 - push.dj});
    const float factor = push.factor / def_.cell;
    const auto p = [&](std::int32_t i, std::int32_t j) { return push.pressure + std::ptrdiff_t{j} * push.columns + i; };
    if (j0 < r.j1 && i0 < r.i1)
        kernels().wave_push_rows(velocity_x_row(j0 + push.dj) + i0 + push.di,
                                 velocity_y_row(j0 + push.dj) + i0 + push.di, stride_, p(i0, j0), push.columns,
                                 r.j1 - j0, r.i1 - i0, factor);
    for (std::int32_t j = r.j0; j < j0 && j < r.j1; ++j) push_cells_row(*this, push, j + push.dj);
    for (std::int32_t i = r.i0; i < i0 && i < r.i1; ++i)
        for (std::int32_t j = j0; j < r.j1; ++j)
            kernels().wave_push(velocity_y_row(j + push.dj) + i + push.di, p(i, j), push.columns, 1, factor);
}

}  // namespace frm
