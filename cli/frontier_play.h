// Plays one scene with several settings in turns, and keeps what bodies felt, how far the water was off, and what ticks
// took.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "cli/frontier_error.h"
#include "cli/frontier_maps.h"
#include "frm.h"

namespace frm::cli {

/// What a world is made of: all that a setting can change.
struct Setup {
    Setup();

    MapFile map;  ///< of all bodies
    frm_world_def world;
    std::optional<frm_water_def> water;
    double dt = 0.002;  ///< s; divides PlayScene::sample
};

struct PlayScene {
    std::string name;
    double seconds = 1;    ///< a whole number of samples
    double sample = 0.02;  ///< s between two comparisons
    double settle = 0.1;   ///< s that are not compared
    std::uint32_t bodies = 1;
    std::function<void(double time, std::uint32_t body, frm_pose&, frm_twist&)> motion;
    /// The water's height at time 0, at rest; null: calm.
    std::function<double(double x, double y)> height;
    /// Where it is known: what the heights should be.
    std::function<double(double x, double y, double time)> exact_height;
};

struct Play {
    Readings readings;             ///< of bodies
    std::optional<Measure> waves;  ///< where the scene has exact heights
    double tick_us = 0;            ///< mean over the ticks of each tick's median over the repeats
    /// Of each repeat, its mean tick: one that took more than twice its median counts as twice that, since it was
    /// interrupted.
    std::vector<double> repeat_us;
};

/// The settings take turns of some ticks each, so that what else the machine does meets all of them alike, and `repeats`
/// times from the beginning. The first ticks of a turn, whose memory the others have just driven out of the caches, are
/// not counted. Throws Failure.
std::vector<Play> play_in_turns(const PlayScene& scene, const std::vector<const Setup*>& setups, std::uint32_t repeats);

}  // namespace frm::cli
