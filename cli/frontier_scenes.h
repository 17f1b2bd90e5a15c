// The scenes of `frm bench frontier`, and the settings that are tried in each.
#pragma once

#include <string>
#include <vector>

#include "cli/frontier_play.h"

namespace frm::cli {

/// One setting of a knob, all else as by default.
struct Choice {
    std::string label;  ///< "25 mm"
    double value = 0;   ///< what `label` says, in the knob's unit
    Setup setup;
    bool standard = false;  ///< this is the default
};

struct Knob {
    std::string name;
    std::string unit;
    std::vector<Choice> choices;  ///< the finest last: what the others are compared with
    bool by_itself = true;        ///< it is one setting of the library, not several together
};

struct FrontierScene {
    PlayScene play;
    std::string what;       ///< of the scene, a sentence
    std::string reference;  ///< of `finest`; empty where the answer is exact
    Setup standard;
    std::vector<Setup> finest;  ///< all knobs at their finest: one, or none
    std::vector<Knob> knobs;
};

/// Names of all, in order; those of frontier_buoyancy.h are not among them.
extern const std::vector<std::string> kPlayedScenes;

/// A scene of kPlayedScenes. `quick`: shorter and with fewer settings.
FrontierScene make_scene(const std::string& name, bool quick);

/// A body towed and turned deep in still water, with maps of it from coarse to fine; the last is what the others are
/// compared with.
FrontierScene make_map_scene(const std::vector<std::string>& maps);

}  // namespace frm::cli
