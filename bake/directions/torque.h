// The torque of a flow, which forces at a few sources do not have by themselves.
#pragma once

#include <memory_resource>
#include <vector>

#include "bake/tasks/forces.h"
#include "core/map/map.h"

namespace frm::bake {

/// A region's force has a moment about its source, which a map does not hold: of a slanted plate, whose pressure falls from
/// one edge to the other, or of a turning body that is a tenth of the torque and more where regions are few. This gives
/// back what is missing of the torque about `centre` as pressures a_l alpha x d_l on the regions, d_l from the sources'
/// centroid and a_l their areas: without a force on the whole, and small where the sources are far apart. Sources in a
/// line stay as they are.
void restore_torque(std::vector<PatchForce>& force, const std::pmr::vector<Source>& sources, const Vec3d& centre,
                    const Vec3d& torque);

}  // namespace frm::bake
