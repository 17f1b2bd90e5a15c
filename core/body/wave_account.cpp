#include "core/body/wave_account.h"

#include <algorithm>
#include <cmath>

#include "core/body/body.h"
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

/// Of the drag's work, what may go into waves: an account knows what a body pays to second order in the waves' height (the
/// body is cut by them, what it displaces by the calm surface), which was up to a ninth of it (tests/stress).
constexpr double covers = 0.8;
/// Time constant, s, by which an overdrawn account is evened out: much of what a stroke spreads comes back with it.
constexpr float overdraft_time = 0.02f;

using Elements = std::pmr::vector<OnLines<ElementBlock>>;

/// Each sixteen, which lie together, as one element of their volume, centroid and second moments.
Elements merged(const Elements& from, std::pmr::memory_resource* memory) {
    Elements out(memory);
    out.reserve((from.size() + kernel_lanes - 1) / kernel_lanes);
    for (std::size_t b = 0; b < from.size(); ++b) {
        const ElementBlock& parts = from[b];
        const float* place[3] = {parts.x, parts.y, parts.z};
        double volume = 0, first[3] = {}, second[3] = {};
        for (std::size_t e = 0; e < kernel_lanes; ++e) {
            const auto v = static_cast<double>(parts.volume[e]);
            volume += v;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto x = static_cast<double>(place[k][e]);
                first[k] += v * x;
                second[k] += v * (x * x + static_cast<double>(parts.spread[k][e]) / 3);
            }
        }
        const std::size_t lane = b % kernel_lanes;
        if (lane == 0) out.emplace_back();
        ElementBlock& whole = out.back();
        float* const to[3] = {whole.x, whole.y, whole.z};
        whole.volume[lane] = static_cast<float>(volume);
        for (std::size_t k = 0; volume > 0 && k < 3; ++k) {
            const double mean = first[k] / volume;
            to[k][lane] = static_cast<float>(mean);
            whole.spread[k][lane] = static_cast<float>(std::max(0.0, 3 * (second[k] / volume - mean * mean)));
        }
    }
    return out;
}

Rect around(const GridPlacement& at, std::int32_t reach) {
    const auto whole = [](float x) { return static_cast<std::int32_t>(std::floor(std::clamp(x, -1e6f, 1e6f))); };
    const std::int32_t i = at.i + whole(at.x), j = at.j + whole(at.y);
    return {i - reach, j - reach, i + reach + 1, j + reach + 1};
}

}  // namespace

WaveAccount::WaveAccount(const VolumeElements& elements, int levels, std::pmr::memory_resource* memory)
    : elements_(memory), points_(memory) {
    // One size serves for all depths, so that nothing changes with them: not the finest, which are for what is narrow.
    int level = elements.finest();
    while (level + 1 < levels && (level == elements.finest() || elements.at(level).size() > enough_blocks)) ++level;
    for (const VolumeElements::Block& block : elements.at(level)) elements_.push_back(block.element);
    while (elements_.size() > enough_blocks) elements_ = merged(elements_, memory);
    for (const ElementBlock& b : elements_) {
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
double WaveAccount::felt(const HeightGrid& water, const Immersion& body, float per_length) const {
    constexpr std::size_t n = kernel_lanes;
    // With a spread of 0, all that is under the calm surface, whatever its depth.
    const SliceLevel all_of_it{1, 0, 0, 0, per_length};
    alignas(64) float h[4 * n], wet[n], none[n];
    double sum = 0;
    for (std::size_t b = 0; b < points_.size(); ++b) {
        const Points& p = points_[b];
        kernels().slice_elements(&elements_[b], &all_of_it, body.depth, body.up.x, body.up.y, body.up.z, wet, none);
        kernels().sample_heights(&water, &body.at, p.x, p.y, p.z, 4 * n, h);
        for (std::size_t e = 0; e < n; ++e)
            sum += static_cast<double>(wet[e]) * static_cast<double>((h[e] + h[n + e]) + (h[2 * n + e] + h[3 * n + e]));
    }
    return 0.25 * sum;
}

/// How far any of its points may have moved since the tick before, in cells.
float WaveAccount::moved(const Immersion& now, float per_length) const {
    const GridPlacement &a = before_.at, &b = now.at;
    const auto along = [](std::int32_t whole, float rest) { return std::fabs(static_cast<float>(whole) + rest); };
    const auto apart = [](const float* p, const float* q) {
        return length(Vec3f(p[0], p[1], p[2]) - Vec3f(q[0], q[1], q[2]));
    };
    const float turned =
        apart(a.along_x, b.along_x) + apart(a.along_y, b.along_y) + per_length * length(now.up - before_.up);
    return along(b.i - a.i, b.x - a.x) + along(b.j - a.j, b.y - a.y) +
           per_length * std::fabs(now.depth - before_.depth) + radius_ * turned;
}

void WaveAccount::charge(const Footprint& footprint, const Field& water, const Immersion& now, float per_length,
                         float weight, float dt, float half_step, float* scratch) {
    const float far = moved(now, per_length);
    // A body that jumps may have left some of its thickness behind, out of its window.
    const bool follows = known_ && !footprint.first && far < static_cast<float>(1 << (footprint.levels() - 1));
    if (!follows) {
        surplus_ = 0;
        ticks_ = 0;
    } else if (ticks_ > 0 && dt == dt_ && far <= 2 * moved_ && credit >= ample * std::fabs(surplus_)) {
        --ticks_;
    } else {
        const auto reach = static_cast<std::int32_t>(std::min(radius_ * per_length, 1e6f)) + 2;
        Rect where = around(now.at, reach);
        where.include(around(before_.at, reach));
        // What raises a basin's level is laid on its mean height.
        const double gets = work_of_change(footprint, water, where, half_step, scratch) +
                            footprint.rest_change() * water.mean_height_set();
        const HeightGrid grid{scratch, water.stride(), water.def().nx, water.def().ny, 0};
        const double pays = felt(grid, now, per_length) - felt(grid, before_, per_length);
        const auto per = static_cast<double>(per_length), cell = static_cast<double>(water.def().cell);
        surplus_ = (gets - pays * (per * per * per * cell)) * (cell * cell * static_cast<double>(weight));
        if (!std::isfinite(surplus_)) surplus_ = 0;  // such water is calmed
        moved_ = far;
        dt_ = dt;
        ticks_ = 0;
        while (ticks_ + 1 < ticks_for_one && static_cast<float>(ticks_ + 2) * dt <= time_for_one) ++ticks_;
    }
    credit -= surplus_;
    before_ = now;
    known_ = true;
}

double work_of_drag(const Body& body, float dt) {
    const Forces& f = body.forces;
    const Twist& twist = body.def.twist;
    const float power = -dot(f.pressure.force + f.friction.force, twist.linear) -
                        dot(f.pressure.torque + f.friction.torque, twist.angular);
    return static_cast<double>(power) * static_cast<double>(dt);
}

float share_of_push(Body& body, Field& water, const Fluid& fluid, float time, std::uint32_t steps) {
    const float step = time / static_cast<float>(steps);
    WaveAccount& account = *body.account;
    const double work = account.drag_work;
    account.drag_work = 0;
    account.credit += covers * work;
    if (!std::isfinite(account.credit)) account.credit = 0;
    if (account.credit < 0) {
        const double due = -account.credit * static_cast<double>(std::min(time / overdraft_time, 1.0f));
        account.credit += take_energy(*body.footprint, water, step * fluid.gravity, fluid.density, due);
    }
    const double all = steps * energy_of_push(*body.footprint, water, step);
    const double most = std::max(std::min(work, account.credit), 0.0);
    const double share = all > most ? most / all : 1.0;
    account.credit -= share * all;
    return static_cast<float>(share);
}

}  // namespace frm
