#include "core/world/wave_clock.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace frm {
namespace {

/// Ticks whose lengths differ by this share are alike, and so is a time to a whole number of steps: rounding.
constexpr float same = 1e-5f;

}  // namespace

/// The steps of ticks that all are of dt.
float WaveClock::step_for(float dt, const Limits& limits) {
    if (limits.may_wait && 2 * dt <= limits.wait) return std::floor(limits.wait / dt) * dt;
    return dt / std::max(1.0f, std::ceil(dt / limits.stable));
}

/// The equal steps' length is that of the steps before. Later it only becomes shorter, for ticks that are, and not below what
/// is waited for anyway: so it changes a few times at most, and however ticks go on nothing is pumped.
float WaveClock::equal_for(float dt, const Limits& limits) const {
    float equal = equal_;
    if (equal == 0 && dt_ > 0 && std::fabs(dt - dt_) > same * dt_)
        equal = std::clamp(step_for(dt_, limits), limits.wait, limits.stable);
    if (equal > limits.wait && 2 * dt < equal) equal = std::max(step_for(dt, limits), limits.wait);
    return equal;
}

WaveTime WaveClock::plan(float dt, const Limits& limits) const {
    const float time = behind_ + dt, equal = equal_for(dt, limits);
    const float needed = equal > 0 ? std::floor(time / equal * (1 + same)) : std::ceil(time / limits.stable);
    if (!(needed <= static_cast<float>(max_substeps)))
        throw Error(FRM_ERROR_LIMIT,
                    "dt = %g s needs %.0f wave steps, more than %u: take a smaller dt, larger cells or less depth",
                    static_cast<double>(dt), static_cast<double>(needed), max_substeps);
    const auto steps = static_cast<std::uint32_t>(needed);
    if (equal > 0) {
        if (steps == 0) return {time, 0, true, time, equal, equal};
        const float taken = needed * equal;
        return {taken, steps, true, std::max(time - taken, 0.0f), equal, equal};
    }
    if (limits.may_wait && time + dt <= limits.wait) return {time, 0, true, time, step_for(dt, limits), 0};
    const std::uint32_t count = std::max(1u, steps);
    return {time, count, behind_ > 0, 0, time / static_cast<float>(count), 0};
}

void WaveClock::advance(float dt, const WaveTime& done) {
    behind_ = done.behind;
    if (done.steps > 0) last_step_ = done.waited ? done.time / static_cast<float>(done.steps) : 0.0f;
    dt_ = dt;
    equal_ = done.equal;
}

void WaveClock::hash(StateHash& hash) const {
    hash.value(behind_);
    hash.value(last_step_);
    if (equal_ > 0) hash.value(equal_);
}

}  // namespace frm
