// How many haptic regions a body needs, by the error that they make: the paper placed its sources by hand.
#pragma once

#include <cstdint>

#include "bake/mesh/surface.h"
#include "bake/regions/region_error.h"

namespace frm::bake {

/// Budgets of the qualities. Few sources, since each costs in every tick, until more buy little: docs/regions.md has
/// the curves that they were chosen from.
constexpr double kDraftRegionError = 0.05, kStandardRegionError = 0.03, kHighRegionError = 0.015;

struct RegionBudget {
    double error = kStandardRegionError;  ///< RegionErrors::whole, above 0
    /// A thin blade's two sides make no error by being one region, but the water that each pushes (section 6.3) needs
    /// them apart: six, the sides of a box, part all sides that a simple body has.
    std::uint32_t least = 6;
    std::uint32_t most = 4096;  ///< at most kMostRegions
};

struct ChosenRegions {
    Regions regions;
    RegionErrors errors;
    /// Whether the errors are within the budget. Not where `most` regions, or one for every four triangles, do not
    /// suffice: then these are that many.
    bool reached = false;
};

/// The fewest regions of split_regions() that are within the budget, to a sixteenth of their number. The surface should
/// have the triangles that a tick works on (sample_triangles()), some ten times as many as there will be regions. The
/// same surface always gives the same regions. Throws BakeError for a budget that makes no sense.
ChosenRegions choose_regions(const Surface& surface, const RegionBudget& budget = {});

}  // namespace frm::bake
