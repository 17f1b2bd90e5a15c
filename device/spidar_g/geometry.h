// A grip on eight strings: where they are fastened, and the rows that both the pose and the tensions are made from.
#pragma once

#include <array>

#include "core/math/quat.h"
#include "core/math/vec.h"

namespace frm::spidar_g {

constexpr int string_count = 8;
using Lengths = std::array<double, string_count>;
using Tensions = std::array<double, string_count>;

struct Fastening {
    Vec3d anchor;      ///< where the string leaves the frame, m, from the device's centre
    Vec3d attachment;  ///< where it is tied to the grip, m, in the grip's frame
};

struct Geometry {
    std::array<Fastening, string_count> strings;
    double lever = 0;  ///< m; rotations and torques are weighed by it, so that all rows are of one unit
};

struct GripPose {
    Vec3d position;
    Quat<double> rotation;
};

struct GripTwist {
    Vec3d linear, angular;  ///< m/s and rad/s, both in the outer frame
};

/// Force in N and torque in N m about the grip's origin.
struct GripWrench {
    Vec3d force, torque;
};

/// What the strings look like from one pose. Row i is (u, (R k) x u / lever), u the unit vector from the grip to the
/// frame: the change of a length by a step (dp, lever dtheta) is -row . step, and a tension t gives the wrench
/// (force, torque / lever) = row t.
struct StringRows {
    double row[string_count][6];
    Lengths length;
};

/// False if a string has no length or a number is not finite; `rows` is then of no use.
bool string_rows(const Geometry& geometry, const GripPose& pose, StringRows& rows);

/// The wrench of these tensions.
GripWrench wrench_of(const StringRows& rows, const Tensions& tensions, double lever);

/// Turns by a small rotation vector, in the outer frame. From + - * / and sqrt alone; the angle is 2 atan(|v| / 2),
/// which is |v| but for |v|^3 / 12.
Quat<double> turned(const Quat<double>& rotation, const Vec3d& vector);

/// The rotation vector from `before` to `after`, in the outer frame; for angles below 0.9 rad within 3e-4 of it.
Vec3d rotation_between(const Quat<double>& before, const Quat<double>& after);

}  // namespace frm::spidar_g
