// The ellipsoid fluid model of MuJoCo, as a peer to compare a tick with: form drag, Stokes friction, Kutta and Magnus
// lift and the velocity part of added mass for one geom, all in water and without a surface.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "cli/frontier_error.h"
#include "core/math/vec.h"
#include "frm.h"

namespace frm::cli {

struct MujocoFluid {
    double nanoseconds = 0;  ///< of a geom: passive forces with a fluid less those without one
    /// Drag coefficient of a box of 8 x 1 x 30 cm in a stream of 0.25 m/s on its largest face. Hoerner's plates of
    /// these proportions have 1.19 (docs/validation-flow.md).
    double plate_drag = 0;
};

/// None if this program was built without MuJoCo.
std::optional<MujocoFluid> measure_mujoco(double seconds);

struct MujocoMotion {
    Readings readings;       ///< force and torque about the body's origin, world axes
    double nanoseconds = 0;  ///< as in MujocoFluid, in the middle of the motion
};

/// What a box of these half sizes about the body's origin feels in deep water at rest that is moved so. None without
/// MuJoCo.
std::optional<MujocoMotion> move_mujoco(const Vec3d& half_sizes,
                                        const std::vector<std::pair<frm_pose, frm_twist>>& motion, double density,
                                        double viscosity, double seconds);

}  // namespace frm::cli
