// What one flat triangle of sources or dipoles does at a point, in closed form.
#pragma once

#include <array>

#include "bake/mesh/surface.h"

namespace frm::bake {

struct Panel {
    std::array<Vec3d, 3> corner;
    std::array<Vec3d, 3> along;     ///< unit vectors along the sides, corner i to the next
    std::array<Vec3d, 3> outward;   ///< unit normals of the sides in the triangle's plane
    std::array<double, 3> length;   ///< of the sides
    std::array<Vec3d, 3> gradient;  ///< of the function that is 1 at corner i and 0 at the others
    Vec3d normal, centre;
    double area = 0;
    double radius = 0;  ///< of the sphere about `centre` that holds the triangle

    Panel() = default;
    /// Corners on a line make a panel without area, which has no normal and no field.
    Panel(const Vec3d& a, const Vec3d& b, const Vec3d& c);
};

/// Integrals over a panel, y on the panel, r the distance from the point x to y (4 pi is left out).
struct PanelField {
    double source = 0;             ///< of 1 / r
    Vec3d moment;                  ///< of (y - x) / r
    std::array<double, 3> dipole;  ///< of d(1/r)/dn times the function that is 1 at corner i
};

/// The potential of constant and linear sources and of linear dipoles (Hess & Smith 1967; Wilton et al. 1984, IEEE
/// Trans. AP-32; the solid angle by Van Oosterom & Strackee 1983). On the panel itself the dipoles give 0, the
/// principal value. x must not lie on a side.
PanelField panel_field(const Panel& panel, const Vec3d& x);

}  // namespace frm::bake
