// Named sets of the settings that trade time for error (docs/performance.md), relative to what a scene says.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "frm.h"

namespace frm::cli {

struct Preset {
    std::string name;
    std::string quality;  ///< of the bake that it is meant for
    double cells;         ///< the scene's edge of a cell times this
    std::uint32_t order;  ///< of the differences in space; 0: as the scene says
};

/// From fast to accurate; "default" is what a scene is without one.
extern const std::vector<Preset> kPresets;

/// Null if there is none of that name.
const Preset* find_preset(const std::string& name);
std::string preset_names(const std::string& between);

/// The same extent of water with other cells.
void apply_preset(const Preset& preset, frm_water_def& water);

}  // namespace frm::cli
