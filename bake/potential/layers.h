// The Galerkin matrices of single and double layers on a triangle surface, for the outer Neumann problem of a moving
// rigid body: what potential does the water have where the body's surface pushes it with a given normal velocity?
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bake/mesh/surface.h"
#include "bake/potential/panel.h"

namespace frm::bake {

using Modes = std::array<double, 6>;  ///< one number for each motion: along x, y, z, about x, y, z

/// With G = 1 / (4 pi r), normals n into the water, `push` g_k the normal velocity of the surface in motion k about
/// the origin, and the piecewise linear functions f_i of the vertices:
struct Layers {
    std::vector<Panel> panels;
    std::vector<double> stiffness;  ///< -<f_i, d/dn of the double layer of f_j>, lower half packed by rows
    std::vector<Modes> load;        ///< <(1/2 + K) f_i, g_k>, K the double layer
    std::array<double, 36> direct;  ///< <g_k, V g_l>, V the single layer
};

/// Where `buried` is set the surface lies inside the body and pushes no water; empty: nowhere. Triangles without area
/// are left out. The same bits for any number of threads (0: OpenMP's own).
Layers make_layers(const Surface& surface, const std::vector<char>& buried, int threads);

/// The normal velocity of a surface with this normal, at x, in each motion.
inline Modes push(const Vec3d& normal, const Vec3d& x) {
    const Vec3d turn = cross(x, normal);
    return {normal.x, normal.y, normal.z, turn.x, turn.y, turn.z};
}

}  // namespace frm::bake
