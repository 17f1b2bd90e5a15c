// What the steps of the wave field cost, beside what the caches and the memory allow.
#pragma once

#include <cstdint>

namespace frm::cli {

/// The roof is the time in which the same core reads, changes and writes in place as many bytes as the field's three
/// arrays have (24 bytes of traffic a cell), measured in turns with the steps. All are the shortest of many times: what
/// a quiet machine gives.
struct WaveSpeed {
    double step_us = 0;
    double roof_us = 0;
    double bytes = 0;  ///< of traffic a step

    double roof_share() const { return roof_us / step_us; }
    double cell_ns() const { return 1e3 * step_us / (bytes / 24); }
};

/// All of `cells` by `cells` active, one step at a time; `steps` of a tick go through the rows together where the water
/// is larger than the caches.
WaveSpeed measure_wave_speed(std::int32_t cells, std::int32_t order, std::uint32_t steps, double seconds);

/// 64 by 64 cells with waves in 2048 by 2048; the median, us a step.
double measure_active_waves(std::int32_t order, double seconds);

}  // namespace frm::cli
