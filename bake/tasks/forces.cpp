#include "bake/tasks/forces.h"

namespace frm::bake {
namespace {

Vec3d vector_at(const std::vector<float>& values, std::size_t i) {
    return Vec3d(Vec3f{values[i], values[i + 1], values[i + 2]});
}

}  // namespace

std::vector<Vec3d> whole_force(const TaskResult& result) {
    std::vector<Vec3d> force(result.samples);
    for (std::size_t s = 0; s < result.samples; ++s)
        for (std::size_t p = 0; p < result.regions; ++p) {
            const std::size_t i = (s * result.regions + p) * 3;
            force[s] += vector_at(result.pressure, i) + vector_at(result.friction, i);
        }
    return force;
}

FlowMeans means_of(const TaskResult& result) {
    FlowMeans out;
    out.patch.resize(result.regions);
    const double share = 1.0 / result.samples;
    for (std::size_t s = 0; s < result.samples; ++s) {
        for (std::size_t p = 0; p < result.regions; ++p) {
            const std::size_t i = (s * result.regions + p) * 3;
            out.patch[p].pressure += vector_at(result.pressure, i) * share;
            out.patch[p].friction += vector_at(result.friction, i) * share;
        }
        out.torque += vector_at(result.torque, 3 * s) * share;
    }
    for (const PatchForce& f : out.patch) out.force += f.pressure + f.friction;
    return out;
}

}  // namespace frm::bake
