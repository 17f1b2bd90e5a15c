// R_p(l, e, s) and R_f(l, e, s) of Eq. 6 in a map's own tables, one source at a time: what the tests of tables and of
// interpolation read. A tick reads core/kernels/lookup.inl, which tests/physics/test_eq6.cpp holds against Eq. 6.
#pragma once

#include <cmath>

#include "core/map/lookup.h"

namespace frm::test {

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

/// By what a blend of three fluctuations is multiplied to be as strong as the three are: of series that are not in
/// phase a part cancels. 1 at the set's own directions; at most 2, because what nearly vanishes has no shape worth
/// enlarging.
inline float fluctuation_level(const Map& map, const DirectionWeights& e) {
    const FaceLevel& face = map.levels[e.face];
    const float* w = e.weight;
    const float a = w[0] * face.rms[0], b = w[1] * face.rms[1], c = w[2] * face.rms[2];
    const float wanted = a + b + c;
    const float crossed = w[1] * w[2] * face.product[0] + w[2] * w[0] * face.product[1] + w[0] * w[1] * face.product[2];
    const float found = a * a + b * b + c * c + 2 * crossed;  // squared
    if (!(found < wanted * wanted)) return 1;
    if (!(found > 0.25f * wanted * wanted)) return 2;
    return wanted / std::sqrt(found);
}

/// Where in the map a stream lies.
struct MapPlace {
    DirectionWeights mean, fluctuation;
    float level = 1;  ///< of the fluctuation
    SpeedPosition speed;
};

/// `direction` (not zero) is where the water goes relative to the source, body frame; its length does not matter.
inline MapPlace place_of(const Map& map, const Vec3f& direction, const SpeedPosition& speed, bool repair_level) {
    MapPlace place;
    place.mean = map.directions.interpolate(direction);
    place.fluctuation = map.one_direction_set() ? place.mean : map.fluctuation_directions.interpolate(direction);
    if (repair_level) place.level = fluctuation_level(map, place.fluctuation);
    place.speed = speed;
    return place;
}

inline void add_fluctuation(const Map& map, std::uint32_t source, std::uint32_t direction, const SamplePosition& s,
                            float level, float (&values)[Map::components]) {
    const std::size_t row = (std::size_t{direction} * map.sources.size() + source) * map.samples;
    const std::int16_t* a = map.fluctuation.data() + (row + s.before) * Map::components;
    const std::int16_t* b = map.fluctuation.data() + (row + s.after) * Map::components;
    const float step = level * map.step[direction];
    for (int c = 0; c < 6; ++c) {
        const float first = static_cast<float>(a[c]);
        values[c] += step * (first + s.share * (static_cast<float>(b[c]) - first));
    }
}

/// Mean and fluctuation are interpolated apart, each over the three directions of its own set around the stream; in one
/// pass where they share the set.
inline SourceForce look_up(const Map& map, std::uint32_t source, const MapPlace& place, const SamplePosition& s) {
    float sum[Map::components] = {};
    const bool one_set = map.one_direction_set();
    for (int k = 0; k < 3; ++k) {
        float values[Map::components];
        frm::detail::add_mean(map, source, place.mean.index[k], place.speed, values);
        if (one_set) add_fluctuation(map, source, place.fluctuation.index[k], s, place.level, values);
        for (int c = 0; c < 6; ++c) sum[c] += place.mean.weight[k] * values[c];
    }
    for (int k = 0; !one_set && k < 3; ++k) {
        float values[Map::components] = {};
        add_fluctuation(map, source, place.fluctuation.index[k], s, place.level, values);
        for (int c = 0; c < 6; ++c) sum[c] += place.fluctuation.weight[k] * values[c];
    }
    return {{sum[0], sum[1], sum[2]}, {sum[3], sum[4], sum[5]}};
}

}  // namespace frm::test
