#include "cli/presets.h"

#include <algorithm>
#include <cmath>

namespace frm::cli {

const std::vector<Preset> kPresets{{"fast", "draft", 2, 2}, {"default", "standard", 1, 0}, {"accurate", "high", 1, 4}};

const Preset* find_preset(const std::string& name) {
    for (const Preset& preset : kPresets)
        if (preset.name == name) return &preset;
    return nullptr;
}

std::string preset_names(const std::string& between) {
    std::string out;
    for (const Preset& preset : kPresets) out += (out.empty() ? "" : between) + preset.name;
    return out;
}

void apply_preset(const Preset& preset, frm_water_def& water) {
    const auto scaled = [&](std::uint32_t cells) {
        return static_cast<std::uint32_t>(std::lround(static_cast<double>(cells) / preset.cells));
    };
    water.nx = scaled(water.nx);
    water.ny = scaled(water.ny);
    water.border_cells = std::min(64u, scaled(water.border_cells));  // the most that there may be
    water.cell = static_cast<float>(preset.cells * static_cast<double>(water.cell));
    if (preset.order) water.order = preset.order;
}

}  // namespace frm::cli
