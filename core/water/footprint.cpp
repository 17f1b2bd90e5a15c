#include "core/water/footprint.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/math/exponential.h"

namespace frm {
namespace {

constexpr std::int32_t alignment = 8;  ///< the window moves by whole cells of the coarsest level
constexpr std::int32_t margin = 24;    ///< around the body: three of the coarsest cells, and another
constexpr std::int32_t largest_window = 512;

/// What moves slowly at depth z below the surface moves the surface as K(r) = z / (2 pi (r^2 + z^2)^(3/2)) does (a
/// source under a free surface at small Froude number, by its image), half of it within r = 1.73 z. A Gaussian of this
/// many depths does the same.
constexpr float widths_per_depth = 1.47f;
/// The spline of a level is as wide as a Gaussian of 0.58 of its cells: 0.5 of its own, and 1/4, 1/16, ... from each
/// gathering.
constexpr float width_of_spline = 0.58f;
constexpr int last_level = Footprint::levels - 1;

FieldDef window_of(const FieldDef& water, float radius) {
    FieldDef def = water;
    const float cells = std::ceil(radius / water.cell);
    const std::int32_t room = largest_window / 2 - margin - alignment;
    const std::int32_t half =
        (cells < static_cast<float>(room) ? static_cast<std::int32_t>(cells) : room) + margin + alignment;
    def.nx = def.ny = 2 * ((half + alignment - 1) / alignment) * alignment;
    def.border = Border::absorbing;
    def.border_cells = 0;
    def.skip_calm_tiles = false;
    return def;
}

/// Quadratic B-spline: smooth in the position, and its weights add up to one.
void spline_weights(float offset, float w[3]) {
    w[0] = 0.5f * (0.5f - offset) * (0.5f - offset);
    w[1] = 0.75f - offset * offset;
    w[2] = 0.5f * (0.5f + offset) * (0.5f + offset);
}

/// Of a column from the surface down to where the width is w: how much of it (in width) a level takes, and how much is
/// left for all of the water.
struct Slices {
    float laid = 0, left = 0;
};

/// A level of cells of width c takes slices in full at w = c, less towards c / 2 and 2 c, in a straight line; the first
/// all that is narrower. The last takes c^2 / w^2 of what is wider, as K(0) goes down; the rest is spread so wide that
/// it counts as even. This is the integral of that from 0 to w.
Slices slices_above(int level, float w) {
    const auto c = static_cast<float>(1 << level);
    const float inverse = 1 / c;
    Slices s;
    if (level == 0) {
        s.laid = std::min(w, c);
    } else {
        const float rise = std::clamp(w - 0.5f * c, 0.0f, 0.5f * c);
        s.laid = rise * rise * inverse;
    }
    if (level < last_level) {
        const float fall = std::clamp(w - c, 0.0f, c);
        s.laid += fall - 0.5f * inverse * fall * fall;
    } else if (w > c) {
        const float narrow = c - c * c / w;
        s.laid += narrow;
        s.left = (w - c) - narrow;
    }
    return s;
}

double volume_of(const std::pmr::vector<float>& thickness, std::int32_t n, const Rect& wet) {
    double sum = 0;
    for (std::int32_t j = wet.j0; j < wet.j1; ++j) {
        const float* row = thickness.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(n);
        for (std::int32_t i = wet.i0; i < wet.i1; ++i) sum += static_cast<double>(row[i]);
    }
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
        shift_array(thickness_before_.data(), n, n, n, di, dj);
        wet_before_ = wet_before_.moved(-di, -dj).clipped(n, n);
    }
}

// A body that jumps leaves its window's old place: the water there falls by what the body displaced.
void Footprint::leave_behind(std::int32_t di, std::int32_t dj, Field& water) const {
    const std::int32_t n = size(), nx = water.def().nx;
    const Rect wet = wet_before_.moved(i0_, j0_).clipped(nx, water.def().ny);
    water.wake(wet);
    for (std::int32_t j = wet.j0; j < wet.j1; ++j) {
        for (std::int32_t i = wet.i0; i < wet.i1; ++i) {
            const std::int32_t wi = i - i0_, wj = j - j0_;
            if (wi >= di && wi < n + di && wj >= dj && wj < n + dj) continue;  // stays in the window
            const std::size_t from =
                static_cast<std::size_t>(wj) * static_cast<std::size_t>(n) + static_cast<std::size_t>(wi);
            water.height_row(j)[i] -= thickness_before_[from];
        }
    }
}

GridOrigin Footprint::body_in_window() const { return {body_.i - i0_, body_.j - j0_, body_.x, body_.y}; }

void Footprint::add(Level& grid, float x, float y, float thickness) {
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

// Two by two cells: enough where gather() smooths what follows, and a third of the time of the spline.
void Footprint::add_coarse(Level& grid, float x, float y, float thickness) {
    const std::int32_t n = grid.size;
    x -= 0.5f, y -= 0.5f;
    if (!(x >= 0 && y >= 0 && x < static_cast<float>(n - 1) && y < static_cast<float>(n - 1))) return;
    const auto i = static_cast<std::int32_t>(x), j = static_cast<std::int32_t>(y);
    const float s = x - static_cast<float>(i), high = thickness * (y - static_cast<float>(j)), low = thickness - high;
    float* row = grid.thickness.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(n) + i;
    row[0] += low - s * low;
    row[1] += s * low;
    row[n] += high - s * high;
    row[n + 1] += s * high;
    grid.wet.include({i, j, i + 2, j + 2});
}

// A face at depth d ends (or, facing up, begins) a column of the body that reaches to the surface. Each slice of that
// column is laid on the level whose spline is as wide as the slice's own depth asks for, so that between the bottom
// and the top of the body each slice counts once, with its own width.
void Footprint::deposit(const Vec3f corner[3], const float depth[3], float area_up, bool spread) {
    const float scale = 1.0f / cell_;
    const float to_width =
        scale * (widths_per_depth / width_of_spline);  // depth to the width that it asks for, in cells
    float x[3], y[3];
    const float base_x = static_cast<float>(body_.i - i0_) + body_.x,
                base_y = static_cast<float>(body_.j - j0_) + body_.y;
    for (int k = 0; k < 3; ++k) {
        x[k] = base_x + corner[k].x * scale;
        y[k] = base_y + corner[k].y * scale;
    }
    const float extent = std::max(std::max({x[0], x[1], x[2]}) - std::min({x[0], x[1], x[2]}),
                                  std::max({y[0], y[1], y[2]}) - std::min({y[0], y[1], y[2]}));
    const float widest = std::max({depth[0], depth[1], depth[2]}) * to_width, to_depth = 1.0f / to_width;
    const float column_area = -area_up * scale * scale;
    for (int level = 0; level < (spread ? levels : 1); ++level) {
        if (level > 0 && widest <= 0.5f * static_cast<float>(1 << level)) break;
        Level& grid = level_[static_cast<std::size_t>(level)];
        const float inverse = 1.0f / static_cast<float>(1 << level);
        // Centres of triangles no further apart than about a cell (two triangles to a square): quadratic splines on such
        // a grid add up evenly, so that front and back of a slanted sheet cancel in every column.
        const std::int32_t parts = 1 + static_cast<std::int32_t>(std::min(extent * inverse * (2.0f / 3), 31.0f));
        const float area = column_area / static_cast<float>(parts * parts);
        const auto lay = [&](float r, float s, float t) {
            const float d = r * depth[0] + s * depth[1] + t * depth[2];
            float thickness = d;
            if (spread) {
                const Slices slices = slices_above(level, d * to_width);
                thickness = slices.laid * to_depth;
                rest_ += static_cast<double>(area * slices.left * to_depth);
            }
            (level == 0 ? add : add_coarse)(grid, (r * x[0] + s * x[1] + t * x[2]) * inverse,
                                            (r * y[0] + s * y[1] + t * y[2]) * inverse,
                                            area * thickness * inverse * inverse);
        };
        if (parts == 1) {
            lay(1.0f / 3, 1.0f / 3, 1.0f / 3);
            continue;
        }
        const float third = 1.0f / (3.0f * static_cast<float>(parts));
        for (std::int32_t a = 0; a < parts; ++a) {
            for (std::int32_t b = 0; b < 2 * (parts - a) - 1; ++b) {
                // Upright parts have their centres at (3a + 1, 3b' + 1), inverted ones at (3a + 2, 3b' + 2), in thirds.
                const std::int32_t odd = b & 1, column = b >> 1;
                const float s = static_cast<float>(3 * a + 1 + odd) * third;
                const float t = static_cast<float>(3 * column + 1 + odd) * third;
                lay(1.0f - s - t, s, t);
            }
        }
    }
}

// Coarse to fine: a quadratic spline on cells of twice the size, in terms of the finer ones (weights 3/4 and 1/4;
// Chaikin 1974).
void Footprint::gather() {
    for (std::size_t k = levels - 1; k > 0; --k) {
        const Level& from = level_[k];
        if (from.wet.empty()) continue;
        Level& to = level_[k - 1];
        const Rect r = Rect{2 * from.wet.i0 - 1, 2 * from.wet.j0 - 1, 2 * from.wet.i1 + 1, 2 * from.wet.j1 + 1}.clipped(
            to.size, to.size);
        const auto value = [&](std::int32_t i, std::int32_t j) {
            if (i < 0 || j < 0 || i >= from.size || j >= from.size) return 0.0f;
            return from.thickness[static_cast<std::size_t>(j) * static_cast<std::size_t>(from.size) +
                                  static_cast<std::size_t>(i)];
        };
        for (std::int32_t j = r.j0; j < r.j1; ++j) {
            const std::int32_t cj = j >> 1, nj = j & 1 ? cj + 1 : cj - 1;
            float* row = to.thickness.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(to.size);
            for (std::int32_t i = r.i0; i < r.i1; ++i) {
                const std::int32_t ci = i >> 1, ni = i & 1 ? ci + 1 : ci - 1;
                row[i] += 0.75f * (0.75f * value(ci, cj) + 0.25f * value(ni, cj)) +
                          0.25f * (0.75f * value(ci, nj) + 0.25f * value(ni, nj));
            }
        }
        to.wet.include(r);
    }
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
    volume_ = volume_of(level_[0].thickness, size(), level_[0].wet) + rest_;
    if (first) first_volume_ = volume_;
    rest_before_ = rest_;
    std::swap(level_[0].thickness, thickness_before_);
    std::swap(level_[0].wet, wet_before_);
    first = false;
}

void Footprint::hash(StateHash& hash) const {
    hash.value(i0_);
    hash.value(j0_);
    hash.value(rest_before_);
    hash.value(first_volume_);
    hash.words(thickness_before_.data(), thickness_before_.size());
    if (active_) own.hash(hash);
}

}  // namespace frm
