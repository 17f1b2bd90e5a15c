#include "bake/potential/panel.h"

#include <algorithm>
#include <cmath>

#include "bake/potential/elementary.h"

namespace frm::bake {

Panel::Panel(const Vec3d& a, const Vec3d& b, const Vec3d& c) : corner{a, b, c} {
    normal = cross(b - a, c - a);
    area = 0.5 * frm::length(normal);
    centre = (a + b + c) / 3.0;
    const bool flat = !(area > 0);
    normal = flat ? Vec3d() : normal / (2 * area);
    double squared = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d side = corner[(i + 1) % 3] - corner[i];
        length[i] = frm::length(side);
        along[i] = length[i] > 0 ? side / length[i] : Vec3d();
        outward[i] = cross(along[i], normal);
        squared = std::max(squared, dot(corner[i] - centre, corner[i] - centre));
    }
    for (std::size_t i = 0; i < 3 && !flat; ++i)
        gradient[i] = outward[(i + 1) % 3] * (-length[(i + 1) % 3] / (2 * area));
    radius = std::sqrt(squared);
}

PanelField panel_field(const Panel& p, const Vec3d& x) {
    const Vec3d to[3] = {p.corner[0] - x, p.corner[1] - x, p.corner[2] - x};
    const double r[3] = {length(to[0]), length(to[1]), length(to[2])};
    double height = -dot(to[0], p.normal);
    // Rounding must not decide on which side of its own plane a point is: half a turn of solid angle hangs on it.
    if (std::abs(height) < 1e-12 * p.radius) height = 0;

    PanelField field{};
    if (!(p.area > 0)) return field;
    Vec3d edge_sum;   // integral of (x0 - y) / r^3, x0 the foot of x in the plane
    Vec3d from_foot;  // integral of (y - x0) / r
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const double ratio = std::min(p.length[i] / (r[i] + r[j]), 1 - 1e-14);
        const double f = 2 * area_tangent(ratio);  // integral of 1 / r along the side
        const double distance = dot(to[i], p.outward[i]);
        const double begin = dot(to[i], p.along[i]), end = begin + p.length[i];
        field.source += distance * f;
        edge_sum += p.outward[i] * f;
        from_foot += p.outward[i] * (0.5 * ((distance * distance + height * height) * f + end * r[j] - begin * r[i]));
    }
    double angle = 0;
    if (height != 0) {
        angle = 2 * angle_of(2 * p.area * height, r[0] * r[1] * r[2] + dot(to[0], to[1]) * r[2] +
                                                      dot(to[1], to[2]) * r[0] + dot(to[2], to[0]) * r[1]);
        field.source -= height * angle;
    }
    field.moment = from_foot - p.normal * (height * field.source);
    for (std::size_t i = 0; i < 3; ++i) {
        const double value = 1 - dot(to[i], p.gradient[i]);  // of the linear function at x
        field.dipole[i] = value * angle - height * dot(p.gradient[i], edge_sum);
    }
    return field;
}

}  // namespace frm::bake
