// Where a body is that a grip holds, and what of its wrench the grip feels. All in the host's axes: quaternions and cross
// products are the same formulas in a left-handed frame.
#pragma once

#include "frm.h"

namespace frm::device {

/// Poses with rotations of length 1.
struct Attachment {
    frm_pose anchor;         ///< of the device's frame in the world
    frm_pose grip;           ///< of the body in the grip
    float motion_scale = 1;  ///< m in the world for each m of the device
};

/// The pose and twist of the body's origin.
frm_pose body_pose(const Attachment& a, const frm_pose& device);
frm_twist body_twist(const Attachment& a, const frm_pose& device, const frm_twist& twist);
/// A wrench about the body's origin in the world, as one about the grip's in the world; and turned into the device's frame.
frm_wrench about_grip(const Attachment& a, const frm_pose& device, const frm_wrench& on_body);
frm_wrench in_device(const Attachment& a, const frm_wrench& in_world);

/// Length 1. Throws Error naming `what` where it is zero or not finite.
frm_quaternion unit(const frm_quaternion& q, const char* what);

}  // namespace frm::device
