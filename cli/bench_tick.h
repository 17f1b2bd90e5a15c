// What whole ticks cost, through the C interface, on one core.
#pragma once

#include <cstdint>
#include <vector>

#include "cli/tick_times.h"

namespace frm::cli {

/// A thin box of 0.2 x 0.02 x 0.6 m, tessellated as the paper's paddle is, with a map made from a formula: a map file.
std::vector<std::uint8_t> bench_map(std::uint32_t sources, std::uint32_t triangles);

struct TickScene {
    std::uint32_t cells = 200;  ///< along each side of the water; 0: a flat surface
    std::uint32_t bodies = 1;   ///< half in the water, moving and turning
    std::uint32_t dry = 0;      ///< more bodies, 10 m above it
    double height = 0;          ///< of the bodies' origin, m
    double dt = 0.002;          ///< s of a tick
    bool moving = true;         ///< else they rest
};

/// Times `ticks` ticks, or as many as there is time for in `seconds` if those are fewer.
TickTimes measure_ticks(const std::vector<std::uint8_t>& map_file, const TickScene& scene, double seconds,
                        std::size_t ticks = 1000000);

}  // namespace frm::cli
