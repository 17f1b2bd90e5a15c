// The mean of Eq. 6 on one source, interpolated in direction and speed, outside of a tick's kernels.
#pragma once

#include "core/map/map.h"
#include "core/math/logarithm.h"

namespace frm {

/// Two of the map's speeds and how far between them a speed lies.
struct SpeedPosition {
    std::uint32_t before = 0, after = 0;
    float share = 0;
};

/// Linear in the logarithm of the Reynolds number, the nearest speed's outside. `speed` is of the map's own size and
/// fluid: the one that has the Reynolds number wanted.
inline SpeedPosition speed_position(const Map& map, float speed) {
    const auto last = static_cast<std::uint32_t>(map.speeds.size() - 1);
    if (last == 0 || !(speed > map.speeds[0])) return {0, 0, 0};
    if (speed >= map.speeds[last]) return {last, last, 0};
    std::uint32_t k = 0;
    while (speed >= map.speeds[k + 1]) ++k;
    const float share = (logarithm(speed) - map.log_speed[k]) / (map.log_speed[k + 1] - map.log_speed[k]);
    // Two speeds may have one logarithm; rounding may leave the interval.
    return {k, k + 1, share > 0 ? (share < 1 ? share : 1.0f) : 0.0f};
}

namespace detail {

inline void add_mean(const Map& map, std::uint32_t source, std::uint32_t direction, const SpeedPosition& speed,
                     float (&values)[Map::components]) {
    const std::size_t count = map.sources.size(), cells = map.directions.count() * count;
    const SourceForce* at = map.mean.data() + direction * count + source;
    const SourceForce& a = at[speed.before * cells];
    for (int c = 0; c < 3; ++c) values[c] = a.pressure[c], values[c + 3] = a.friction[c];
    if (!(speed.share > 0)) return;
    const SourceForce& b = at[speed.after * cells];
    for (int c = 0; c < 3; ++c) {
        values[c] += speed.share * (b.pressure[c] - a.pressure[c]);
        values[c + 3] += speed.share * (b.friction[c] - a.friction[c]);
    }
}

}  // namespace detail

/// The mean force of a stream (m/s, body frame, where the water goes relative to the source) on a source, N, at the
/// map's own size and fluid: Eq. 6 without its fluctuation. No speed, no force.
inline SourceForce mean_force(const Map& map, std::uint32_t source, const Vec3f& stream) {
    const float speed = length(stream);
    if (!(speed > 0)) return {};
    const DirectionWeights e = map.directions.interpolate(stream);
    const SpeedPosition at = speed_position(map, speed);
    SourceForce out;
    for (int k = 0; k < 3; ++k) {
        float values[Map::components];
        detail::add_mean(map, source, e.index[k], at, values);
        for (int c = 0; c < 3; ++c) {
            out.pressure[c] += e.weight[k] * values[c];
            out.friction[c] += e.weight[k] * values[c + 3];
        }
    }
    const float ratio = speed / map.facts.base_speed;
    return {out.pressure * (ratio * ratio), out.friction * ratio};
}

}  // namespace frm
