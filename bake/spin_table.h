// Rotation: which turns are solved, and what they add to the map beyond the local streams of its sources.
#pragma once

#include <vector>

#include "bake/bake.h"
#include "bake/directions/transfer.h"

namespace frm::bake {

/// Of the six angular velocities +-x, +-y, +-z (DirectionSet(1)) those that no isometry makes of another one; unit.
std::vector<Vec3d> distinct_spins(const Symmetry& symmetry);

/// map.spin: the mean forces of the plan's spins less what the map's means give for the local streams of the same turn.
void fill_spin(Map& map, const BakePlan& plan, const std::vector<FlowMeans>& means, Transfers& transfers);

}  // namespace frm::bake
