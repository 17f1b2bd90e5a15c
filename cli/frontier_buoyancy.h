// Buoyancy by itself: the clip of frm against points that are under water, the usual scheme of games, on an ellipsoid whose
// displaced volume under a plane is known in closed form.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/frontier_error.h"
#include "core/math/vec.h"

namespace frm::cli {

/// Volume that an ellipsoid about the origin has where dot(up, x) < level, and the centroid of that; `up` of length 1.
struct Cap {
    double volume = 0;
    Vec3d centroid;
};
Cap cap_below(const Vec3d& half_axes, const Vec3d& up, double level);

/// Points of a cubic lattice within the ellipsoid, each standing for as much of its volume: about `count`, and how high a
/// cell of the lattice is.
struct PointBody {
    std::vector<Vec3f> points;
    double volume = 0;  ///< of each, m^3
    double height = 0;  ///< m
};
PointBody point_body(const Vec3d& half_axes, std::uint32_t count);

/// One way of working buoyancy out, over all poses.
struct BuoyancyWay {
    std::string knob;  ///< "triangles"; "points counted", "points smoothed"
    double value = 0;  ///< how many
    bool standard = false;
    double us = 0;  ///< of one evaluation: median over the repeats
    std::vector<double> repeat_us;
    Readings readings;
};

struct BuoyancyScene {
    Readings reference;  ///< in calm water the exact answer, in waves that of the finest surface
    std::vector<BuoyancyWay> ways;
};

/// A hull of 1.2 x 0.5 x 0.4 m that heaves, rolls and pitches half in the water. `quick`: fewer ways.
BuoyancyScene measure_buoyancy(bool waves, std::uint32_t repeats, bool quick);

}  // namespace frm::cli
