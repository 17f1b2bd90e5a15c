// Which wrenches the strings can display at a pose, given their limits: a zonotope, described by its facets.
#pragma once

#include "device/spidar_g/tensions.h"

namespace frm::spidar_g {

struct WrenchRange {
    bool full_rank = false;  ///< six independent rows: the strings fix the pose
    bool closure = false;    ///< strings that only pull can make a wrench of every direction
    bool rest = false;       ///< no wrench at all can be displayed within the limits, with room in every direction
    double force = 0;        ///< N, a pure force of this strength is reachable in every direction; 0 without `rest`
    double torque = 0;       ///< N m, the same of pure torques
};

/// By hyperplane shifting (Bouchard, Gosselin and Moore 2010): each facet's normal is orthogonal to five of the rows.
WrenchRange wrench_range(const StringRows& rows, const TensionLimits& limits, double lever);

}  // namespace frm::spidar_g
