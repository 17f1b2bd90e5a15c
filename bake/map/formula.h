// A map from a formula instead of a flow: what benchmarks and tests run on, made in milliseconds.
#pragma once

#include <cstdint>

#include "bake/mesh/surface.h"
#include "core/map/map.h"

namespace frm::bake {

/// Each source is pressed by rho/2 u^2 A (e . n)^2 where the stream e meets it (n . e < 0), sucked at half of that at
/// its lee, and rubbed by 0.01 rho/2 u^2 A along e; the fluctuation is a sine of a tenth of the mean with two periods.
/// Base speed 0.5 m/s, water.
Map formula_map(const Surface& surface, std::uint32_t sources, std::uint32_t frequency, std::uint32_t samples);

}  // namespace frm::bake
