// Where a body is that a grip holds, and what of its wrench the grip feels. All in the host's axes: quaternions and cross
// products are the same formulas in a left-handed frame.
#pragma once

#include "core/body/body.h"
#include "frm.h"

namespace frm::device {

/// Poses with rotations of length 1.
struct Attachment {
    frm_pose anchor;         ///< of the device's frame in the world
    frm_pose grip;           ///< of the body in the grip
    float motion_scale = 1;  ///< m in the world for each m of the device
};

/// From the grip's origin to the body's, in the world.
Vec3f lever(const Attachment& a, const frm_pose& device);
/// The pose and twist of the body's origin.
frm_pose body_pose(const Attachment& a, const frm_pose& device);
frm_twist body_twist(const Attachment& a, const frm_pose& device, const frm_twist& twist);
/// A wrench about the body's origin as one about the grip's, from where `arm` leads to the body; in frm's own axes.
Wrench about_grip(const Vec3f& arm, const Wrench& on_body);
/// Turned from the world into the device's frame.
frm_wrench in_device(const Attachment& a, const frm_wrench& in_world);

/// Length 1. Throws Error naming `what` where it is zero or not finite.
frm_quaternion unit(const frm_quaternion& q, const char* what);

}  // namespace frm::device
