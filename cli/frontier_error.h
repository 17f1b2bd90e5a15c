// How far one run of a scene is off another, and which settings nothing beats.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/math/vec.h"

namespace frm::cli {

/// An error as shares of the reference's peak.
struct Measure {
    double rms = 0;
    double worst = 0;
};

/// Force and torque on one body at one time.
struct Reading {
    Vec3d force, torque;
};
/// Of all bodies, time after time.
using Readings = std::vector<Reading>;

struct ForceError {
    Measure force, torque;
};

struct Peak {
    double force = 0;   ///< N
    double torque = 0;  ///< N m
};
Peak peak_of(const Readings& readings);

/// Both must have the same times and bodies.
ForceError error_of(const Readings& readings, const Readings& reference);

/// Of points (time, error): those that no other beats in one without being worse in the other. What is within 3 % is even,
/// so that of settings which cost the same chance does not choose.
std::vector<bool> frontier_of(const std::vector<double>& time, const std::vector<double>& error);

/// The middle of the sorted values; quartiles with share 0.25 and 0.75.
double quantile_of(std::vector<double> values, double share);

}  // namespace frm::cli
