// Moments of a surface and the axes that they single out: where the axes of a symmetry can be.
#pragma once

#include <array>
#include <vector>

#include "bake/math/matrix.h"
#include "bake/mesh/surface.h"

namespace frm::bake {

/// Second moments of area about a point: integral of x x^T dA. Eigenvalues from the largest (the direction in which the
/// surface is longest) to the smallest, m^4; axes unit, right-handed.
struct PrincipalAxes {
    std::array<double, 3> moment{};
    std::array<Vec3d, 3> axis;
};

PrincipalAxes principal_axes(const Surface& surface, const Vec3d& centre);

/// Directions in which the sixth moment of area, f(d) = integral of (d . x)^6 dA, is stationary on the sphere; unit,
/// one of each pair d and -d, at most `most`.
///
/// Every rotation axis and every normal of a mirror plane is among them: f is even, so it does not tell a mirror from
/// the half turn about its normal, and a rotation about d leaves no direction across d into which f could rise. The
/// sixth degree is the least at which a cube, a tetrahedron and an icosahedron all differ from a sphere.
std::vector<Vec3d> stationary_axes(const Surface& surface, const Vec3d& centre, std::size_t most);

}  // namespace frm::bake
