// The grip's pose from the lengths of its strings: damped Gauss-Newton from the last pose.
#pragma once

#include "device/spidar_g/geometry.h"

namespace frm::spidar_g {

/// Eight lengths fix six unknowns twice over; what is left over tells of strings that cannot be right.
struct PoseFit {
    GripPose pose;
    StringRows rows;     ///< of that pose
    Lengths residual{};  ///< measured less fitted, m: positive where a string seems too long
    /// Over sqrt(1 - leverage): the largest names the string that is most likely wrong (Baarda 1968).
    Lengths normalised_residual{};
    double residual_rms = 0;  ///< m
    int iterations = 0;
    bool converged = false;
};

/// Never more steps than this.
constexpr int pose_iterations = 8;

/// Fits a pose to `lengths`, beginning at `start`. Not converged: the lengths are not numbers, or too far from any pose
/// near the start; fit.pose is then `start`.
PoseFit fit_pose(const Geometry& geometry, const Lengths& lengths, const GripPose& start);

}  // namespace frm::spidar_g
