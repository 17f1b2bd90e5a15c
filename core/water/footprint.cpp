#include "core/water/footprint.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/math/exponential.h"

namespace frm {
namespace {

constexpr std::int32_t border_cells = 8;            ///< of the window's absorbing layer
constexpr std::int32_t alignment = 8;               ///< the window moves by whole cells of the coarsest level
constexpr std::int32_t margin = 16 + border_cells;  ///< around the body: three of the coarsest cells, and the layer
constexpr std::int32_t largest_window = 512;

/// What moves slowly at depth z below the surface moves the surface as K(r) = z / (2 pi (r^2 + z^2)^(3/2)) does (a
/// source under a free surface at small Froude number, by its image), half of it within r = 1.73 z. A Gaussian of this
/// many depths does the same.
constexpr float widths_per_depth = 1.47f;
/// The spline of a level is as wide as a Gaussian of 0.58 of its cells: 0.5 of its own, and 1/4, 1/16, ... from each
/// gathering.
constexpr float width_of_spline = 0.58f;

FieldDef window_of(const FieldDef& water, float radius) {
    FieldDef def = water;
    const float cells = std::ceil(radius / water.cell);
    const std::int32_t room = largest_window / 2 - margin - alignment;
    const std::int32_t half =
        (cells < static_cast<float>(room) ? static_cast<std::int32_t>(cells) : room) + margin + alignment;
    def.nx = def.ny = 2 * ((half + alignment - 1) / alignment) * alignment;
    def.border = Border::absorbing;
    def.border_cells = border_cells;
    return def;
}

/// Quadratic B-spline: smooth in the position, and its weights add up to one.
void spline_weights(float offset, float w[3]) {
    w[0] = 0.5f * (0.5f - offset) * (0.5f - offset);
    w[1] = 0.75f - offset * offset;
    w[2] = 0.5f * (0.5f + offset) * (0.5f + offset);
}

double volume_of(const std::pmr::vector<float>& thickness) {
    double sum = 0;
    for (const float t : thickness) sum += static_cast<double>(t);
    return sum;
}

}  // namespace

Footprint::Footprint(const FieldDef& water, float radius, std::pmr::memory_resource* memory)
    : own(window_of(water, radius), memory),
      cell_(water.cell),
      level_{{{std::pmr::vector<float>(memory), 0, {}},
              {std::pmr::vector<float>(memory), 0, {}},
              {std::pmr::vector<float>(memory), 0, {}},
              {std::pmr::vector<float>(memory), 0, {}}}},
      thickness_before_(own.cells(), 0.0f, memory),
      pressure_(own.cells(), 0.0f, memory) {
    for (int k = 0; k < levels; ++k) {
        level_[static_cast<std::size_t>(k)].size = size() >> k;
        level_[static_cast<std::size_t>(k)].thickness.assign(own.cells() >> (2 * k), 0.0f);
    }
}

void Footprint::begin(std::int32_t i, std::int32_t j, const GridOrigin& body, Field* water) {
    // The window's first cell is a multiple of the alignment in the water, so that the coarse cells never move against
    // the water.
    const auto align = [](std::int32_t a) {
        return (a >= 0 ? a / alignment : -((-a + alignment - 1) / alignment)) * alignment;
    };
    const std::int32_t di = i - size() / 2 - i0_, dj = j - size() / 2 - j0_;
    if (first || di >= alignment || di < 0 || dj >= alignment || dj < 0)
        shift(align(i - size() / 2) - i0_, align(j - size() / 2) - j0_, water);
    body_ = body;
    rest_ = 0;
    for (Level& level : level_) {
        if (!level.wet.empty()) std::fill(level.thickness.begin(), level.thickness.end(), 0.0f);
        level.wet = {};
    }
    if (!pressed_.empty()) std::fill(pressure_.begin(), pressure_.end(), 0.0f);
    pressed_ = {};
}

void Footprint::shift(std::int32_t di, std::int32_t dj, Field* water) {
    if (water) leave_behind(di, dj, *water);
    i0_ += di;
    j0_ += dj;
    const std::int32_t n = size();
    if (active_) {
        if (di >= n || di <= -n || dj >= n || dj <= -n)
            own.calm();
        else
            own.shift(di, dj);
    }
    if (!wet_before_.empty()) {
        shift_array(thickness_before_.data(), n, n, di, dj);
        wet_before_ = wet_before_.moved(-di, -dj).clipped(n, n);
    }
}

// A body that jumps leaves its window's old place: the water there falls by what the body displaced.
void Footprint::leave_behind(std::int32_t di, std::int32_t dj, Field& water) const {
    const std::int32_t n = size(), nx = water.def().nx;
    const Rect wet = wet_before_.moved(i0_, j0_).clipped(nx, water.def().ny);
    for (std::int32_t j = wet.j0; j < wet.j1; ++j) {
        for (std::int32_t i = wet.i0; i < wet.i1; ++i) {
            const std::int32_t wi = i - i0_, wj = j - j0_;
            if (wi >= di && wi < n + di && wj >= dj && wj < n + dj) continue;  // stays in the window
            const std::size_t from =
                static_cast<std::size_t>(wj) * static_cast<std::size_t>(n) + static_cast<std::size_t>(wi);
            water.height()[static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i)] -=
                thickness_before_[from];
        }
    }
}

GridOrigin Footprint::body_in_window() const { return {body_.i - i0_, body_.j - j0_, body_.x, body_.y}; }

void Footprint::add(float x, float y, float thickness) {
    Level& grid = level_[0];
    const std::int32_t n = grid.size;
    if (!(x >= 1.0f && y >= 1.0f && x < static_cast<float>(n - 1) && y < static_cast<float>(n - 1))) return;
    const auto i = static_cast<std::int32_t>(x), j = static_cast<std::int32_t>(y);
    float wx[3], wy[3];
    spline_weights(x - static_cast<float>(i) - 0.5f, wx);
    spline_weights(y - static_cast<float>(j) - 0.5f, wy);
    for (std::int32_t q = 0; q < 3; ++q) {
        float* row =
            grid.thickness.data() + static_cast<std::size_t>(j - 1 + q) * static_cast<std::size_t>(n) + (i - 1);
        for (std::int32_t p = 0; p < 3; ++p) row[p] += thickness * wy[q] * wx[p];
    }
    grid.wet.include({i - 1, j - 1, i + 2, j + 2});
}

void Footprint::deposit(const Vec3f corner[3], const float depth[3], float area_up) {
    const float scale = 1.0f / cell_;
    float x[3], y[3];
    const float base_x = static_cast<float>(body_.i - i0_) + body_.x,
                base_y = static_cast<float>(body_.j - j0_) + body_.y;
    for (int k = 0; k < 3; ++k) {
        x[k] = base_x + corner[k].x * scale;
        y[k] = base_y + corner[k].y * scale;
    }
    const float extent = std::max(std::max({x[0], x[1], x[2]}) - std::min({x[0], x[1], x[2]}),
                                  std::max({y[0], y[1], y[2]}) - std::min({y[0], y[1], y[2]}));
    // Points no further apart than a cell: quadratic splines on such a grid add up evenly, so that front and back of a
    // slanted sheet cancel in every column.
    const std::int32_t parts = std::clamp(static_cast<std::int32_t>(std::ceil(std::min(extent, 32.0f))), 1, 32);
    const float third = 1.0f / (3.0f * static_cast<float>(parts));
    const float share = -area_up / (static_cast<float>(parts * parts) * cell_ * cell_);
    for (std::int32_t a = 0; a < parts; ++a) {
        for (std::int32_t b = 0; b < 2 * (parts - a) - 1; ++b) {
            // Centres of the parts: upright ones at (3a + 1, 3b' + 1), inverted ones at (3a + 2, 3b' + 2), in thirds.
            const std::int32_t odd = b & 1, column = b >> 1;
            const float s = static_cast<float>(3 * a + 1 + odd) * third;
            const float t = static_cast<float>(3 * column + 1 + odd) * third;
            const float r = 1.0f - s - t;
            add(r * x[0] + s * x[1] + t * x[2], r * y[0] + s * y[1] + t * y[2],
                share * (r * depth[0] + s * depth[1] + t * depth[2]));
        }
    }
}

// Cells of twice the size hold the mean of four.
void Footprint::coarsen(std::size_t to) {
    const Level& from = level_[to - 1];
    Level& coarse = level_[to];
    const std::int32_t n = from.size;
    coarse.wet = Rect{from.wet.i0 >> 1, from.wet.j0 >> 1, (from.wet.i1 + 1) >> 1, (from.wet.j1 + 1) >> 1};
    for (std::int32_t j = coarse.wet.j0; j < coarse.wet.j1; ++j) {
        const float* low = from.thickness.data() + static_cast<std::size_t>(2 * j) * static_cast<std::size_t>(n);
        const float* high = low + n;
        float* row = coarse.thickness.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(coarse.size);
        for (std::int32_t i = coarse.wet.i0; i < coarse.wet.i1; ++i)
            row[i] = 0.25f * ((low[2 * i] + low[2 * i + 1]) + (high[2 * i] + high[2 * i + 1]));
    }
}

// A quadratic spline on cells of twice the size, in terms of the finer ones (weights 3/4 and 1/4; Chaikin 1974), replaces the
// finer level's thickness; of that, 1 - share stays.
void Footprint::refine(std::size_t from_level, float share) {
    const Level& from = level_[from_level];
    Level& to = level_[from_level - 1];
    const Rect r = Rect{2 * from.wet.i0 - 1, 2 * from.wet.j0 - 1, 2 * from.wet.i1 + 1, 2 * from.wet.j1 + 1}.clipped(
        to.size, to.size);
    const auto value = [&](std::int32_t i, std::int32_t j) {
        if (i < 0 || j < 0 || i >= from.size || j >= from.size) return 0.0f;
        return from
            .thickness[static_cast<std::size_t>(j) * static_cast<std::size_t>(from.size) + static_cast<std::size_t>(i)];
    };
    for (std::int32_t j = r.j0; j < r.j1; ++j) {
        const std::int32_t cj = j >> 1, nj = j & 1 ? cj + 1 : cj - 1;
        float* row = to.thickness.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(to.size);
        for (std::int32_t i = r.i0; i < r.i1; ++i) {
            const std::int32_t ci = i >> 1, ni = i & 1 ? ci + 1 : ci - 1;
            const float smooth = 0.75f * (0.75f * value(ci, cj) + 0.25f * value(ni, cj)) +
                                 0.25f * (0.75f * value(ci, nj) + 0.25f * value(ni, nj));
            row[i] = (1 - share) * row[i] + share * smooth;
        }
    }
    to.wet.include(r);
}

void Footprint::spread(float cover) {
    const float width =
        cover / cell_ * (widths_per_depth / width_of_spline);  // in cells of the level whose spline is as wide
    if (!(width > 1.0f) || level_[0].wet.empty()) return;
    std::size_t level = 0;  // the one below the width; the next has the rest
    while (level + 2 < levels && width >= static_cast<float>(2 << level)) ++level;
    const auto cells = static_cast<float>(1 << level);
    const float widest = 2 * cells, next = std::min(1.0f, width / cells - 1);
    const double before = volume_of(level_[0].thickness);
    for (std::size_t k = 1; k <= level + 1; ++k) coarsen(k);
    refine(level + 1, next);
    for (std::size_t k = level; k > 0; --k) refine(k, 1.0f);
    if (!(width > widest)) return;

    // Deeper than the widest spline reaches, the surface above moves less by the square of the width, as K(0) does; the rest
    // is spread so wide that it is taken as even over all of the water.
    const float keep = (widest / width) * (widest / width);
    for (float& t : level_[0].thickness) t *= keep;
    rest_ = (1 - static_cast<double>(keep)) * before;
}

float Footprint::deposited_share() const {
    return volume_ > 0 ? static_cast<float>(std::clamp(1 - first_volume_ / volume_, 0.0, 1.0)) : 0.0f;
}

void Footprint::splat_pressure(const Vec3f& at, float pressure, float area, float depth) {
    constexpr std::int32_t reach = 24;  // cells to each side
    // Gaussians of half a spacing's width add up to an even field within 1.5 % (their first harmonic is 2 exp(-pi^2 /
    // 2)).
    const float below = depth > 0 ? widths_per_depth * depth : 0.0f;
    float width = std::max(0.7f, std::sqrt(0.25f * area + below * below) / cell_), keep = 1;
    constexpr float widest = static_cast<float>(reach) / 3.0f;
    if (width > widest) {
        keep = below > 0 ? (widest / width) * (widest / width) : 1.0f;
        width = widest;
    }
    const float px = static_cast<float>(body_.i - i0_) + body_.x + at.x / cell_;
    const float py = static_cast<float>(body_.j - j0_) + body_.y + at.y / cell_;
    const std::int32_t n = size();
    if (!(px >= 0 && py >= 0 && px < static_cast<float>(n) && py < static_cast<float>(n))) return;
    const auto ci = static_cast<std::int32_t>(px), cj = static_cast<std::int32_t>(py);
    const auto half = static_cast<std::int32_t>(std::ceil(3.0f * width));
    float wx[2 * reach + 1], wy[2 * reach + 1], sum_x = 0, sum_y = 0;
    for (std::int32_t k = -half; k <= half; ++k) {
        const float dx = (static_cast<float>(ci + k) + 0.5f - px) / width,
                    dy = (static_cast<float>(cj + k) + 0.5f - py) / width;
        sum_x += wx[k + half] = exponential(-0.5f * dx * dx);
        sum_y += wy[k + half] = exponential(-0.5f * dy * dy);
    }
    const float amount = keep * pressure * area / (cell_ * cell_ * sum_x * sum_y);
    const Rect r = Rect{ci - half, cj - half, ci + half + 1, cj + half + 1}.clipped(n, n);
    for (std::int32_t j = r.j0; j < r.j1; ++j) {
        float* row = pressure_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(n);
        const float row_amount = amount * wy[j - cj + half];
        for (std::int32_t i = r.i0; i < r.i1; ++i) row[i] += row_amount * wx[i - ci + half];
    }
    pressed_.include(r);
}

void Footprint::end() {
    active_ = active();
    volume_ = volume_of(level_[0].thickness) + rest_;
    if (first) first_volume_ = volume_;
    rest_before_ = rest_;
    std::swap(level_[0].thickness, thickness_before_);
    std::swap(level_[0].wet, wet_before_);
    first = false;
}

void Footprint::hash(StateHash& hash) const {
    hash.value(i0_);
    hash.value(j0_);
    hash.words(thickness_before_.data(), thickness_before_.size());
    if (active_) own.hash(hash);
}

}  // namespace frm
