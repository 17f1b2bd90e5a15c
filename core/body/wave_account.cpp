#include "core/body/wave_account.h"

#include <algorithm>
#include <cmath>

#include "core/kernels/kernels.h"
#include "core/water/coupling.h"

namespace frm {
namespace {

/// Elements, in blocks of sixteen, that suffice for how the water's height differs over a body.
constexpr std::size_t enough_blocks = 2;
/// With a credit of this many times what a tick takes, one tick's surplus stands for those of so many s.
constexpr double ample = 64;
constexpr float time_for_one = 8e-3f;
constexpr std::uint32_t ticks_for_one = 4;  ///< at most
/// Of an element's four points, which have its second moments: a height of second degree has its mean at them.
constexpr float sign[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};

Rect around(const GridPlacement& at, std::int32_t reach) {
    const auto i = at.i + static_cast<std::int32_t>(std::floor(at.x)),
               j = at.j + static_cast<std::int32_t>(std::floor(at.y));
    return {i - reach, j - reach, i + reach + 1, j + reach + 1};
}

}  // namespace

WaveAccount::WaveAccount(const VolumeElements& elements, int levels, std::pmr::memory_resource* memory)
    : level_(elements.finest()), points_(memory) {
    // The finest are for what is narrow at the surface: here one size serves for all depths, so that nothing changes with it.
    while (level_ + 1 < levels && (level_ == elements.finest() || elements.at(level_).size() > enough_blocks)) ++level_;
    points_.reserve(elements.at(level_).size());
    for (const VolumeElements::Block& block : elements.at(level_)) {
        const ElementBlock& b = block.element;
        points_.emplace_back();
        Points& points = points_.back();
        for (std::size_t n = 0; n < 4; ++n)
            for (std::size_t e = 0; e < kernel_lanes; ++e) {
                const auto off = [&](std::size_t k) { return sign[n][k] * std::sqrt(b.spread[k][e] * (1.0f / 3)); };
                const std::size_t p = n * kernel_lanes + e;
                const Vec3f at(b.x[e] + off(0), b.y[e] + off(1), b.z[e] + off(2));
                points.x[p] = at.x, points.y[p] = at.y, points.z[p] = at.z;
                radius_ = std::max(radius_, length(at));
            }
    }
}

/// The sum of h dV over the volume that is under the calm surface, in metres times the map's volumes.
double WaveAccount::felt(const VolumeElements& elements, const HeightGrid& water, const Immersion& body,
                         float per_length) const {
    constexpr std::size_t n = kernel_lanes;
    const VolumeElements::Blocks& blocks = elements.at(level_);
    const SliceLevel all_of_it{1, 0, 0, 0, per_length};
    alignas(64) float h[4 * n], wet[n], none[n];
    double sum = 0;
    for (std::size_t b = 0; b < points_.size(); ++b) {
        const Points& p = points_[b];
        kernels().slice_elements(&blocks[b].element, &all_of_it, body.depth, body.up.x, body.up.y, body.up.z, wet,
                                 none);
        kernels().sample_heights(&water, &body.at, p.x, p.y, p.z, 4 * n, h);
        for (std::size_t e = 0; e < n; ++e)
            sum += static_cast<double>(wet[e]) * static_cast<double>((h[e] + h[n + e]) + (h[2 * n + e] + h[3 * n + e]));
    }
    return 0.25 * sum;
}

/// How far any of its points may have moved since the tick before, in cells.
float WaveAccount::moved(const Immersion& now, float per_length) const {
    const auto along = [](std::int32_t whole, float rest) { return std::fabs(static_cast<float>(whole) + rest); };
    return along(now.at.i - before_.at.i, now.at.x - before_.at.x) +
           along(now.at.j - before_.at.j, now.at.y - before_.at.y) +
           per_length * (std::fabs(now.depth - before_.depth) + radius_ * length(now.up - before_.up));
}

void WaveAccount::charge(const VolumeElements& elements, const Footprint& footprint, const Field& water,
                         const Immersion& now, float per_length, float weight, float dt, float half_step,
                         float* scratch) {
    const float far = moved(now, per_length);
    // A body that jumps may have left some of its thickness behind, out of its window.
    const bool follows = known_ && !footprint.first && far < static_cast<float>(1 << (footprint.levels() - 1));
    if (!follows) {
        surplus_ = 0;
        ticks_ = 0;
    } else if (ticks_ > 0 && far <= 2 * moved_ && credit >= ample * std::fabs(surplus_)) {
        --ticks_;
    } else {
        const auto reach = static_cast<std::int32_t>(std::min(radius_ * per_length, 1e6f)) + 2;
        Rect where = around(now.at, reach);
        where.include(around(before_.at, reach));
        const double gets = work_of_change(footprint, water, where, half_step, scratch);
        const HeightGrid grid{scratch, water.stride(), water.def().nx, water.def().ny, 0};
        const double pays = felt(elements, grid, now, per_length) - felt(elements, grid, before_, per_length);
        const auto per = static_cast<double>(per_length), cell = static_cast<double>(water.def().cell);
        surplus_ = (gets - pays * (per * per * per * cell)) * (cell * cell * static_cast<double>(weight));
        if (!std::isfinite(surplus_)) surplus_ = 0;  // such water is calmed
        moved_ = far;
        ticks_ = 0;
        while (ticks_ + 1 < ticks_for_one && static_cast<float>(ticks_ + 2) * dt <= time_for_one) ++ticks_;
    }
    credit -= surplus_;
    before_ = now;
    known_ = true;
}

}  // namespace frm
