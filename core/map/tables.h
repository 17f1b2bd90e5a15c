// A map's tables laid out for a tick: a lookup is bound by latency, so that what one source needs of one direction is one
// cache line or less. Made from the map's own tables, which stay as they are in the file; costs their memory once more.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "core/kernels/lookup.h"

namespace frm {

struct Map;

/// Of a force that a rule leaves out: its share of the body's peak force at the largest relative speed of its sources.
/// The rules' shares together stay under a half of the 1e-5 that a tick promises against Eq. 6.
constexpr float skip_share = 2e-6f;

struct MapTables {
    explicit MapTables(std::pmr::memory_resource* memory);

    std::pmr::vector<float> position[3];  ///< [axis][source], zero up to a whole block
    std::pmr::vector<FaceCorners> corners, swing_corners;
    std::pmr::vector<ForceRow> mean;   ///< [speed][direction][source]
    std::pmr::vector<SwingRow> swing;  ///< [direction][source][samples + 1]
    std::pmr::vector<ForceRow> spin;   ///< [axis][source]
    /// 1 for sources whose fluctuations may be left out: those that fluctuate least, as many as together stay under
    /// skip_share of the peak force whatever the direction, the time and the speed.
    std::pmr::vector<std::uint8_t> steady;
    std::uint32_t steady_sources = 0;
    float peak_pressure = 0;  ///< N, of the whole body's mean at the base speed; the smallest of the speeds'
    float swing_pressure = 0, swing_friction = 0;  ///< N, the largest that fluctuations can add up to, by part
    float friction_sum = 0;                        ///< N, the largest that frictions can add up to at the base speed
    bool any_swing = false;                        ///< the map fluctuates at all
    float reach = 0;                               ///< m, of the source furthest from the origin

    /// From the map's own tables, which must be complete.
    void fill(const Map& map);
};

/// The tables of `map` for the kernels, until the map ends or is changed.
LookupTable lookup_table(const Map& map);

}  // namespace frm
