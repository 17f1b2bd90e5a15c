// The fluctuations that a map stores: periodic, in step between neighbouring directions, as strong as the flow's.
#pragma once

#include <vector>

#include "bake/directions/region_forces.h"
#include "bake/map/fill.h"
#include "bake/series/periodic.h"
#include "core/map/directions.h"

namespace frm::bake {

/// For each direction of the set. `results[k]` is the record of flow k of `forces`; the threshold is of the force on a
/// region, N.
std::vector<Fluctuation> fluctuations(const RegionForces& forces, const std::vector<const TaskResult*>& results,
                                      std::uint32_t regions, const DirectionSet& directions, const PeriodicSpec& spec);

}  // namespace frm::bake
