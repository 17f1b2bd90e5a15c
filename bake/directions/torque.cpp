#include "bake/directions/torque.h"

#include "bake/math/matrix.h"

namespace frm::bake {

void restore_torque(std::vector<PatchForce>& force, const std::pmr::vector<Source>& sources, const Vec3d& centre,
                    const Vec3d& torque) {
    Vec3d missing = torque, middle;
    double area = 0;
    for (std::size_t l = 0; l < force.size(); ++l) {
        const Vec3d at(sources[l].position);
        const double a = static_cast<double>(sources[l].area);
        missing -= cross(at - centre, force[l].pressure + force[l].friction);
        middle += at * a;
        area += a;
    }
    middle = middle / area;
    // sum of a_l d x (alpha x d) = M alpha.
    Matrix3 m{};
    for (Vec3d& row : m.row) row = {};
    for (const Source& source : sources) {
        const Vec3d d = Vec3d(source.position) - middle;
        const double a = static_cast<double>(source.area);
        for (int i = 0; i < 3; ++i) {
            Vec3d& row = m.row[static_cast<std::size_t>(i)];
            row -= d * (a * d[i]);
            row[i] += a * dot(d, d);
        }
    }
    // Sources in a line cannot bear a torque about it.
    constexpr double least = 1e-6;
    const double trace = m.row[0].x + m.row[1].y + m.row[2].z, det = determinant(m);
    if (!(det > least * trace * trace * trace)) return;
    const Vec3d alpha = (cross(m.row[1], m.row[2]) * missing.x + cross(m.row[2], m.row[0]) * missing.y +
                         cross(m.row[0], m.row[1]) * missing.z) /
                        det;
    for (std::size_t l = 0; l < force.size(); ++l)
        force[l].pressure += cross(alpha, Vec3d(sources[l].position) - middle) * static_cast<double>(sources[l].area);
}

}  // namespace frm::bake
