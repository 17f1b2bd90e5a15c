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

void Footprint::begin(std::int32_t i, std::int32_t j, const GridOrigin& body) {
    // The window's first cell is a multiple of the alignment in the water, so that the coarse cells never move against
    // the water.
    const auto align = [](std::int32_t a) {
        return (a >= 0 ? a / alignment : -((-a + alignment - 1) / alignment)) * alignment;
    };
    const std::int32_t di = i - size() / 2 - i0_, dj = j - size() / 2 - j0_;
    if (first || di >= alignment || di < 0 || dj >= alignment || dj < 0)
        shift(align(i - size() / 2) - i0_, align(j - size() / 2) - j0_);
    body_ = body;
    for (Level& level : level_) {
        if (!level.wet.empty()) std::fill(level.thickness.begin(), level.thickness.end(), 0.0f);
        level.wet = {};
    }
    if (!pressed_.empty()) std::fill(pressure_.begin(), pressure_.end(), 0.0f);
    pressed_ = {};
}

void Footprint::shift(std::int32_t di, std::int32_t dj) {
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

GridOrigin Footprint::body_in_window() const { return {body_.i - i0_, body_.j - j0_, body_.x, body_.y}; }

void Footprint::add(int level, float x, float y, float thickness) {
    Level& grid = level_[static_cast<std::size_t>(level)];
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

void Footprint::deposit(const Vec3f corner[3], const float depth[3], float area_up, bool spread) {
    const float scale = 1.0f / cell_;
    float x[3], y[3];
    const float base_x = static_cast<float>(body_.i - i0_) + body_.x,
                base_y = static_cast<float>(body_.j - j0_) + body_.y;
    for (int k = 0; k < 3; ++k) {
        x[k] = base_x + corner[k].x * scale;
        y[k] = base_y + corner[k].y * scale;
    }
    // The level whose spline is as wide as the depth asks for, in part and the next one in part; what would reach
    // beyond the coarsest is dropped: it is spread so thin.
    int level = 0;
    float next = 0, keep = 1;
    if (spread) {
        const float width =
            (depth[0] + depth[1] + depth[2]) * (1.0f / 3) * scale * (widths_per_depth / width_of_spline);
        while (level < levels - 1 && width >= static_cast<float>(2 << level)) ++level;
        const float cells = static_cast<float>(1 << level);
        if (level == levels - 1) {
            if (width > cells) keep = (cells / width) * (cells / width);
        } else if (width > cells) {
            next = width / cells - 1;
        }
    }

    const float extent = std::max(std::max({x[0], x[1], x[2]}) - std::min({x[0], x[1], x[2]}),
                                  std::max({y[0], y[1], y[2]}) - std::min({y[0], y[1], y[2]})) /
                         static_cast<float>(1 << level);
    // Points no further apart than a cell: quadratic splines on such a grid add up evenly, so that front and back of a
    // slanted sheet cancel in every column.
    const std::int32_t parts = std::clamp(static_cast<std::int32_t>(std::ceil(extent)), 1, 32);
    const float third = 1.0f / (3.0f * static_cast<float>(parts));
    const float share = -keep * area_up / (static_cast<float>(parts * parts) * cell_ * cell_);
    const float fine = 1.0f / static_cast<float>(1 << level), coarse = 0.5f * fine;
    for (std::int32_t a = 0; a < parts; ++a) {
        for (std::int32_t b = 0; b < 2 * (parts - a) - 1; ++b) {
            // Centres of the parts: upright ones at (3a + 1, 3b' + 1), inverted ones at (3a + 2, 3b' + 2), in thirds
            // of a part.
            const std::int32_t odd = b & 1, column = b >> 1;
            const float s = static_cast<float>(3 * a + 1 + odd) * third;
            const float t = static_cast<float>(3 * column + 1 + odd) * third;
            const float r = 1.0f - s - t;
            const float px = r * x[0] + s * x[1] + t * x[2], py = r * y[0] + s * y[1] + t * y[2];
            const float amount = share * (r * depth[0] + s * depth[1] + t * depth[2]);
            add(level, px * fine, py * fine, amount * (1 - next) * fine * fine);
            if (next > 0) add(level + 1, px * coarse, py * coarse, amount * next * coarse * coarse);
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
