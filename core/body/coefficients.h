// How the fluid's force on a body changes with its motion: what a host needs that integrates light bodies.
#pragma once

#include <array>

#include "core/body/body.h"

namespace frm {

/// Six by six, row after row: force x, y, z, torque x, y, z about the body's origin for (rows) motion along x, y, z and
/// about x, y, z (columns), world axes. Both are symmetric and positive semi-definite (added_mass as far as the map's is).
struct Coefficients {
    float wet_share = 0;                  ///< of the surface
    std::array<double, 36> added_mass{};  ///< kg, kg m, kg m^2; zero if the map has none
    std::array<double, 36> damping{};     ///< N s/m, N s, N m s
};

/// Of the last tick: its pose, wetness and streams.
Coefficients coefficients_of(const Body& body, const Fluid& fluid);

}  // namespace frm
