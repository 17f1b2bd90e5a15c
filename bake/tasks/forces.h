// What a solved flow says of each patch: its mean force.
#pragma once

#include <vector>

#include "bake/tasks/task.h"

namespace frm::bake {

struct PatchForce {
    Vec3d pressure, friction;  ///< N, mesh's frame
};

struct FlowMeans {
    std::vector<PatchForce> patch;
    Vec3d force;   ///< of the whole body, N
    Vec3d torque;  ///< of the whole body about the mesh's origin, N m
};

FlowMeans means_of(const TaskResult& result);

/// The force on the whole body at each sample, N.
std::vector<Vec3d> whole_force(const TaskResult& result);

}  // namespace frm::bake
