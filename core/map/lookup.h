// R_p(l, e, s) and R_f(l, e, s) of Eq. 6: the force on one source, interpolated in direction and map time.
#pragma once

#include "core/map/map.h"

namespace frm {

/// Two samples of the period and how far between them a map time lies.
struct SamplePosition {
    std::uint32_t before = 0, after = 0;
    float share = 0;
};

/// `time` in [0, period).
inline SamplePosition sample_position(const Map& map, float time) {
    const float position = time / map.facts.period * static_cast<float>(map.samples);
    auto before = static_cast<std::uint32_t>(position);
    if (before >= map.samples) before = map.samples - 1;
    return {before, before + 1 == map.samples ? 0 : before + 1, position - static_cast<float>(before)};
}

/// Mean and fluctuation are interpolated apart, each over the three directions around `e`.
inline SourceForce look_up(const Map& map, std::uint32_t source, const DirectionWeights& e, const SamplePosition& s) {
    float sum[Map::components] = {};
    for (int k = 0; k < 3; ++k) {
        const std::size_t cell = std::size_t{e.index[k]} * map.sources.size() + source;
        const SourceForce& mean = map.mean[cell];
        const std::int16_t* series = map.fluctuation.data() + cell * map.samples * Map::components;
        const std::int16_t* a = series + std::size_t{s.before} * Map::components;
        const std::int16_t* b = series + std::size_t{s.after} * Map::components;
        const float weight = e.weight[k], step = map.step[e.index[k]];
        for (int c = 0; c < 6; ++c) {
            const float steady = c < 3 ? mean.pressure[c] : mean.friction[c - 3];
            const float first = static_cast<float>(a[c]);
            sum[c] += weight * (steady + step * (first + s.share * (static_cast<float>(b[c]) - first)));
        }
    }
    return {{sum[0], sum[1], sum[2]}, {sum[3], sum[4], sum[5]}};
}

}  // namespace frm
