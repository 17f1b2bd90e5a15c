// Level of detail: neighbouring sources taken together as one group with one stream, whose mean force and torque are
// summed beforehand. From the whole body as one group to pairs of sources; each level knows by how much it can be wrong.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "core/kernels/lookup.h"

namespace frm {

struct Map;

/// What bounds the error of a level, all at the base speed in the map's own size and fluid. The error of a group is that
/// of its sources' streams, which differ where the body turns, and of the fluctuations, which it has not. A source's
/// pressure goes like u^2 R(e) with a gradient of at most L u: off by at most L max(u, u') |u - u'|, in units of u0.
struct LevelBound {
    float turning = 0;                    ///< N m: sum over sources of L times the distance from the group's centre
    float turning_squared = 0;            ///< N m^2: that times the larger distance of the two from the body's origin
    float turning_friction = 0;           ///< N m: of frictions, which go like u R(e)
    float swing = 0, swing_friction = 0;  ///< N: the largest that fluctuations can add up to
};

/// How a body moves, as a bound needs it.
struct LevelMotion {
    float speed = 0;                   ///< of the body's origin against the water, over the base speed
    float turning = 0;                 ///< |angular velocity| * scale over the base speed, 1/m
    float pressure = 0, friction = 0;  ///< the similarity laws' factors
};

struct Level {
    explicit Level(std::pmr::memory_resource* memory);

    std::uint32_t groups = 0;
    std::pmr::vector<std::uint32_t> begin;  ///< [groups + 1]: into MapLevels::order
    std::pmr::vector<float> position[3];    ///< [axis][group], m: area-weighted centre; zero up to a whole block
    std::pmr::vector<float> area;           ///< [group], m^2
    std::pmr::vector<ForceRow> rows;  ///< means, [speed][direction][group]; then torques about the centre, the same
    std::pmr::vector<ForceRow> spin;  ///< [axis][group], then its torques; empty without a spin table
    LevelBound bound;

    /// N: by how much the force of this level can differ from that of all sources, where every group is wholly wet or
    /// wholly dry. The torque about the origin differs by no more than that times the body's reach.
    float error(const LevelMotion& motion, float reach) const;
};

struct MapLevels {
    explicit MapLevels(std::pmr::memory_resource* memory);

    static constexpr std::uint32_t most = 8;

    std::pmr::vector<std::uint32_t> order;  ///< sources, so that the groups of every level are ranges
    std::pmr::vector<Level> level;          ///< from one group, each with twice as many; empty for a map of one source
    /// [source], N: the largest that its pressure and friction can be, fluctuation left out.
    std::pmr::vector<float> most_pressure, most_friction;

    /// From a map whose other tables are complete.
    void fill(const Map& map);
};

/// The tables of a level for the kernels, as those of a map of so many sources without fluctuations.
LookupTable lookup_table(const Map& map, const Level& level);

}  // namespace frm
