// What the body's part of a tick costs: wet surface, displaced volume, and their way into the water.
#pragma once

#include <cstdint>
#include <vector>

namespace frm::cli {

/// Medians of one call, in microseconds, for a moving body in waves on 200 x 200 cells.
struct BodyTimes {
    double cut = 0;           ///< wet surface, half wet
    double wet = 0;           ///< wet surface, wholly wet under waves
    double calm = 0;          ///< wet surface, wholly wet under calm water
    double displacement = 0;  ///< laying the displaced volume, half wet
    double still = 0;         ///< the same, of a body that has not moved
    double coupling = 0;      ///< the change of the thickness into the water and the body's own waves
};

BodyTimes measure_body(const std::vector<std::uint8_t>& map_file, double seconds);

}  // namespace frm::cli
