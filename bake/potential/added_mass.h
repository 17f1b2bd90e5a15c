// The added mass of a rigid body: what the water around it adds to its inertia.
#pragma once

#include <array>
#include <cstddef>

#include "bake/mesh/surface.h"

namespace frm::bake {

struct AddedMass {
    /// Row by row; rows are force along x, y, z and torque about x, y, z, columns the accelerations alike, about the
    /// mesh's origin. kg, kg m, kg m^2. Exactly symmetric, and positive semidefinite.
    std::array<double, 36> matrix{};
    /// Estimated error of the diagonal about the body's centroid along its principal axes, the largest of six. Each is
    /// a share of the entry, or of 2 % of the largest force, and of that times the squared radius of gyration of the
    /// surface for torques (or of 2 % of the largest torque), where the entry is smaller: a sphere's torques are 0, and
    /// so is their error.
    double error = 0;
    /// Share of the surface that lies inside another piece of the body, where no water is. Where it is more than 0 the
    /// matrix may be some percent too small on top of `error` (docs/added-mass.md).
    double buried = 0;
    std::size_t triangles = 0;  ///< of the finest mesh that was solved
};

struct AddedMassSettings {
    double density = 1000;  ///< of the fluid, kg/m^3
    std::size_t most_triangles =
        3200;         ///< of the finest mesh: time and memory grow with its square (docs/added-mass.md)
    int threads = 0;  ///< 0: OpenMP's own number; the result does not depend on it
};

/// In unbounded fluid at rest, without friction. `surface` as repair() leaves it: closed shells, outward. Throws
/// BakeError if a number is out of range or the surface has too many shells to be solved.
AddedMass added_mass(const Surface& surface, const AddedMassSettings& settings = {});

}  // namespace frm::bake
