#include "bake/spin_table.h"

#include <cmath>

#include "bake/directions/torque.h"
#include "core/map/lookup.h"

namespace frm::bake {
namespace {

constexpr double same = 1e-6;  // chord

/// Isometries enough to find every one of the six axes among the images of another.
std::vector<Matrix3> isometries(const Symmetry& symmetry) {
    constexpr double quarter = 1.57079632679489661923;
    std::vector<Matrix3> out;
    const auto turns = [&](const Vec3d& axis, const std::vector<Matrix3>& of) {
        std::vector<Matrix3> made;
        for (int k = 0; k < 4; ++k)
            for (const Matrix3& g : of) made.push_back(rotation_about(axis, quarter * k) * g);
        return made;
    };
    switch (symmetry.kind) {
        case SymmetryKind::finite:
            return symmetry.elements;
        case SymmetryKind::spherical:
            return turns({1, 0, 0}, turns({0, 1, 0}, turns({0, 0, 1}, {Matrix3{}})));
        default:
            // A mirror plane through the axis turns a spin about the axis round.
            return turns(symmetry.axis, {Matrix3{}, mirror_across(any_across(symmetry.axis))});
    }
}

/// Angular velocity is an axial vector.
Vec3d carried(const Matrix3& g, const Vec3d& spin) { return (g * spin) * determinant(g); }

}  // namespace

std::vector<Vec3d> distinct_spins(const Symmetry& symmetry) {
    const std::vector<Matrix3> all = isometries(symmetry);
    const DirectionSet axes(1);
    std::vector<Vec3d> kept;
    for (std::uint32_t d = 0; d < axes.count(); ++d) {
        bool known = false;
        for (const Vec3d& spin : kept)
            for (const Matrix3& g : all) known = known || length(carried(g, spin) - axes.direction(d)) < same;
        if (!known) kept.push_back(axes.direction(d));
    }
    return kept;
}

void fill_spin(Map& map, const BakePlan& plan, const std::vector<FlowMeans>& means, Transfers& transfers) {
    const std::vector<Matrix3> all = isometries(plan.symmetry);
    const DirectionSet axes(1);
    Vec3d centre;
    for (std::uint32_t d = 0; d < axes.count(); ++d) {
        std::vector<PatchForce> force;
        Vec3d torque;
        bool found = false;
        for (std::size_t k = 0; k < means.size() && !found; ++k) {
            if (plan.tasks[k].kind != TaskKind::spin) continue;
            centre = plan.tasks[k].flow.spin_centre;
            const Vec3d spin = plan.tasks[k].flow.spin / length(plan.tasks[k].flow.spin);
            // The mean over all that make the same turn of it, as of streams: what a flow has by chance averages out.
            std::vector<Matrix3> by;
            for (const Matrix3& g : all)
                if (length(carried(g, spin) - axes.direction(d)) < same) by.push_back(g);
            if (by.empty()) continue;
            found = true;
            force = transfers.mean(means[k].patch, by);
            const double part = 1.0 / static_cast<double>(by.size());
            const Vec3d about_centre = means[k].torque - cross(centre, means[k].force);
            for (const Matrix3& g : by) torque += carried(g, about_centre) * part;
        }
        if (!found) throw BakeError("bake: the spin about an axis is missing");
        restore_torque(force, map.sources, centre, torque);
        const Vec3f spin(axes.direction(d) * plan.spin_rate);
        for (std::uint32_t l = 0; l < plan.regions.count; ++l) {
            const SourceForce local = mean_force(map, l, cross(map.sources[l].position - Vec3f(centre), spin));
            map.spin.force.push_back(
                {Vec3f(force[l].pressure) - local.pressure, Vec3f(force[l].friction) - local.friction});
        }
    }
    map.spin.rate = static_cast<float>(plan.spin_rate);
    map.spin.centre = Vec3f(centre);
}

}  // namespace frm::bake
