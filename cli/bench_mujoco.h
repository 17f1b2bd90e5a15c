// The ellipsoid fluid model of MuJoCo, as a peer to compare a tick with: form drag, Stokes friction, Kutta and Magnus
// lift and the velocity part of added mass for one geom, all in water and without a surface.
#pragma once

#include <optional>

namespace frm::cli {

struct MujocoFluid {
    double nanoseconds = 0;  ///< of a geom: passive forces with a fluid less those without one
    /// Drag coefficient of a box of 8 x 1 x 30 cm in a stream of 0.25 m/s on its largest face. Hoerner's plates of
    /// these proportions have 1.19 (docs/validation-flow.md).
    double plate_drag = 0;
};

/// None if this program was built without MuJoCo.
std::optional<MujocoFluid> measure_mujoco(double seconds);

}  // namespace frm::cli
