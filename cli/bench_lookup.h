// What the resistance of a body costs (Eq. 6), without the rest of a tick: for frm bench.
#pragma once

#include <cstdint>
#include <vector>

namespace frm::cli {

/// Nanoseconds, each the median of batches over `seconds` of wall time.
struct LookupTimes {
    double source;     ///< a source, all of its tick: a smooth stroke, as a hand or a game moves a body
    double scattered;  ///< the same, each tick another direction: no table's line is where the last tick left it
    double coarse;     ///< the whole body as one group of sources, wholly wet in water at rest, turning
};

/// A wholly wet body, no waves.
LookupTimes measure_lookup(const std::vector<std::uint8_t>& map_file, double seconds);

}  // namespace frm::cli
