#include "core/water/footprint.h"

#include <algorithm>
#include <cmath>

#include "core/math/exponential.h"

namespace frm {
namespace {

constexpr std::int32_t largest_window = 512;
constexpr float widest_splat = 8;  ///< cells of a Gaussian that a large source presses

/// The window moves by whole cells of the coarsest level.
std::int32_t alignment_of(int levels) { return 1 << (levels - 1); }
/// Around the body: two of the coarsest cells, which Pyramid::add keeps free, and by how much the window lags behind.
std::int32_t margin_of(int levels) { return 3 * alignment_of(levels); }

/// A body feels its own waves over its plan, sqrt(V / D) wide at a draught D; what it displaces there is asked for
/// widths_per_depth D wide. The lesser of the two is largest where they are alike: it goes with cbrt(V), whatever the shape.
/// With 0.44, 0.33 and 0.22 of that a hull's buoyancy is off by 0.2, 1.4 and 4 % of its peak (rms, measured).
constexpr double widest_per_size = 0.44;

/// So many that the widest is as wide in metres however small the cells are, as far as the largest window goes.
int levels_for(const FieldDef& water, float radius, double volume) {
    const double wanted =
        widest_per_size * widest_per_size * widest_per_size * volume;  // a cube: std::cbrt is not exact
    const auto suffices = [&](int levels) {
        const double width = static_cast<double>(Pyramid::width_of[levels - 1] * water.cell);
        return width * width * width >= wanted || width >= static_cast<double>(widths_per_depth * water.depth);
    };
    const auto fits = [&](int levels) {
        return std::ceil(radius / water.cell) <= static_cast<float>(largest_window / 2 - margin_of(levels));
    };
    int levels = Pyramid::fewest_levels;
    while (levels < Pyramid::most_levels && !suffices(levels) && fits(levels + 1)) ++levels;
    return levels;
}

FieldDef window_of(const FieldDef& water, float radius, int levels) {
    FieldDef def = water;
    const float cells = std::ceil(radius / water.cell);
    const std::int32_t alignment = alignment_of(levels), margin = margin_of(levels);
    const std::int32_t room = largest_window / 2 - margin;
    const std::int32_t half = (cells < static_cast<float>(room) ? static_cast<std::int32_t>(cells) : room) + margin;
    def.nx = def.ny = 2 * ((half + alignment - 1) / alignment) * alignment;
    def.border = Border::absorbing;
    def.border_cells = 0;
    def.skip_calm_tiles = true;  // a window without waves costs nothing
    // What is taken off the water's velocity may be off by that of such a wave: 1e-4 m/s in half a metre of water.
    def.calm = 5e-5f * std::min(water.depth, 20 * water.cell);
    return def;
}

}  // namespace

Footprint::Footprint(const FieldDef& water, float radius, double volume, std::pmr::memory_resource* memory)
    : Footprint(water, radius, levels_for(water, radius, volume), memory) {}

Footprint::Footprint(const FieldDef& water, float radius, int levels, std::pmr::memory_resource* memory)
    : own(window_of(water, radius, levels), memory),
      cell_(water.cell),
      thickness_(own.def().nx, levels, memory),
      pressure_(own.def().nx, levels, memory),
      thickness_before_(own.cells(), 0.0f, memory) {}

void Footprint::begin(std::int32_t i, std::int32_t j, const GridOrigin& body, Field* water) {
    // The window's first cell is a multiple of the alignment in the water, so that the coarse cells never move against
    // the water.
    const std::int32_t alignment = alignment_of(levels());
    const auto align = [alignment](std::int32_t a) {
        return (a >= 0 ? a / alignment : -((-a + alignment - 1) / alignment)) * alignment;
    };
    const std::int32_t di = i - size() / 2 - i0_, dj = j - size() / 2 - j0_;
    if (first || di >= alignment || di < 0 || dj >= alignment || dj < 0)
        shift(align(i - size() / 2) - i0_, align(j - size() / 2) - j0_, water);
    body_ = body;
    base_x_ = static_cast<float>(body.i - i0_) + body.x;
    base_y_ = static_cast<float>(body.j - j0_) + body.y;
    laid_ = rest_ = 0;
    kept_ = false;
    thickness_.clear();
    pressure_.clear();
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

void Footprint::deposit(int level, float x, float y, float amount) {
    const float scale = 1.0f / static_cast<float>(1 << level);
    if (thickness_.add(level, (base_x_ + x) * scale, (base_y_ + y) * scale, amount * (scale * scale)))
        laid_ += static_cast<double>(amount);
    else
        rest_ += static_cast<double>(amount);
}

void Footprint::gather() { thickness_.gather(); }

bool Footprint::is_deep(float shallowest) const {
    const float width = widths_per_depth * shallowest;  // the middle goes down with its square
    const float widest = thickness_.widest() * cell_;
    return shallowest > 0 && widest * widest < deep_share * width * width;
}

void Footprint::keep() { kept_ = true; }

float Footprint::deposited_share() const {
    return volume_ > 0 ? static_cast<float>(std::clamp(1 - first_volume_ / volume_, 0.0, 1.0)) : 0.0f;
}

void Footprint::splat_pressure(const Vec3f& at, float pressure, float area, float depth) {
    // Gaussians of half a spacing's width add up to an even field within 1.5 % (their first harmonic is 2 exp(-pi^2 /
    // 2)).
    const float below = depth > 0 ? widths_per_depth * depth : 0.0f, inverse = 1.0f / cell_;
    const float narrow = 0.5f * std::sqrt(area) * inverse;
    const float width = std::sqrt(narrow * narrow + (below * inverse) * (below * inverse));
    const float x = base_x_ + at.x * inverse, y = base_y_ + at.y * inverse;
    const float widest = std::max(pressure_.widest(), std::min(narrow, widest_splat));
    // Deeper than the widest, the middle goes down as K(0) does; a large area is only so much too narrow.
    const float keep = width > widest && below > 0 ? (widest / width) * (widest / width) : 1.0f;
    const float amount = keep * pressure * area * (inverse * inverse);
    if (widest > pressure_.widest())
        splat_wide(x, y, std::min(width, widest), amount);
    else
        pressure_.add_wide(x, y, std::min(width, widest), amount);
}

void Footprint::gather_pressure(float most) {
    pressure_.gather();
    const Rect& r = pressed();
    for (std::int32_t j = r.j0; j < r.j1; ++j) {
        float* const p = pressure_.row(j);
        for (std::int32_t i = r.i0; i < r.i1; ++i) p[i] = std::min(std::max(p[i], -most), most);
    }
}

// A Gaussian cell by cell: for a source of many cells.
void Footprint::splat_wide(float x, float y, float width, float amount) {
    constexpr auto reach = static_cast<std::int32_t>(3 * widest_splat);  // cells to each side
    const std::int32_t n = size();
    if (!(x >= 0 && y >= 0 && x < static_cast<float>(n) && y < static_cast<float>(n))) return;
    const auto ci = static_cast<std::int32_t>(x), cj = static_cast<std::int32_t>(y);
    const auto half = static_cast<std::int32_t>(std::ceil(3.0f * width));
    float wx[2 * reach + 1], wy[2 * reach + 1], sum_x = 0, sum_y = 0;
    for (std::int32_t k = -half; k <= half; ++k) {
        const float dx = (static_cast<float>(ci + k) + 0.5f - x) / width,
                    dy = (static_cast<float>(cj + k) + 0.5f - y) / width;
        sum_x += wx[k + half] = exponential(-0.5f * dx * dx);
        sum_y += wy[k + half] = exponential(-0.5f * dy * dy);
    }
    const float each = amount / (sum_x * sum_y);
    const Rect r = Rect{ci - half, cj - half, ci + half + 1, cj + half + 1}.clipped(n, n);
    for (std::int32_t j = r.j0; j < r.j1; ++j) {
        float* row = pressure_.row(j);
        const float row_amount = each * wy[j - cj + half];
        for (std::int32_t i = r.i0; i < r.i1; ++i) row[i] += row_amount * wx[i - ci + half];
    }
    pressure_.include(r);
}

void Footprint::end() {
    active_ = own.active_cells() > 0;
    if (kept_) return;
    volume_ = laid_ + rest_;
    if (first) first_volume_ = volume_;
    rest_before_ = rest_;
    thickness_.swap_finest(thickness_before_, wet_before_);
    first = false;
}

void Footprint::hash(StateHash& hash) const {
    hash.value(i0_);
    hash.value(j0_);
    hash.value(rest_before_);
    hash.value(first_volume_);
    hash.value(volume_);
    hash.value(static_cast<std::uint32_t>(first));
    hash.words(thickness_before_.data(), thickness_before_.size());
    if (active_) own.hash(hash);
}

}  // namespace frm
