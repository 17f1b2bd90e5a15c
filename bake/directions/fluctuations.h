// The fluctuations that a map stores: periodic, in step between neighbouring directions, as strong as the flow's.
#pragma once

#include <vector>

#include "bake/directions/region_forces.h"
#include "bake/map/fill.h"
#include "core/map/directions.h"

namespace frm::bake {

struct FluctuationSpec {
    std::uint32_t period = 0;     ///< samples of a flow's record that make one period; even
    std::uint32_t samples = 0;    ///< of the map's period; even
    std::uint32_t harmonics = 0;  ///< the highest kept
    double threshold = 0;  ///< N; weaker harmonics of the force on a region are dropped (section 5.2 of the paper)
};

/// For each direction of the set. `results[k]` is the record of flow k of `forces`.
std::vector<Fluctuation> fluctuations(const RegionForces& forces, const std::vector<const TaskResult*>& results,
                                      std::uint32_t regions, const DirectionSet& directions,
                                      const FluctuationSpec& spec);

}  // namespace frm::bake
