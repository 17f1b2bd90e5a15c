#include "device/servo/attachment.h"

#include <cmath>

#include "core/error.h"
#include "core/math/quat.h"

namespace frm::device {
namespace {

Vec3f plain(const frm_vec3& v) { return {v.x, v.y, v.z}; }
frm_vec3 plain(const Vec3f& v) { return {v.x, v.y, v.z}; }
Vec3d plain(const frm_position& p) { return {p.x, p.y, p.z}; }
Quat<float> plain(const frm_quaternion& q) { return {q.x, q.y, q.z, q.w}; }

Quat<float> normal(const Quat<float>& q) {
    const float size = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {q.x / size, q.y / size, q.z / size, q.w / size};
}

Rotation<float> turn(const Quat<float>& q) { return Rotation<float>(normal(q)); }

}  // namespace

Vec3f lever(const Attachment& a, const frm_pose& device) {
    return turn(plain(a.anchor.rotation) * normal(plain(device.rotation))).to_world(Vec3f(plain(a.grip.position)));
}

frm_quaternion unit(const frm_quaternion& q, const char* what) {
    const double size = std::sqrt(
        static_cast<double>(q.x) * static_cast<double>(q.x) + static_cast<double>(q.y) * static_cast<double>(q.y) +
        static_cast<double>(q.z) * static_cast<double>(q.z) + static_cast<double>(q.w) * static_cast<double>(q.w));
    if (!(size > 1e-6 && size < 1e6)) throw Error(FRM_ERROR_ARGUMENT, "%s is not a rotation", what);
    const auto part = [size](float v) { return static_cast<float>(static_cast<double>(v) / size); };
    return {part(q.x), part(q.y), part(q.z), part(q.w)};
}

frm_pose body_pose(const Attachment& a, const frm_pose& device) {
    const Vec3f along =
        turn(plain(a.anchor.rotation)).to_world(Vec3f(plain(device.position)) * a.motion_scale) + lever(a, device);
    const Quat<float> q = plain(a.anchor.rotation) * normal(plain(device.rotation)) * plain(a.grip.rotation);
    const Quat<float> r = normal(q);
    const frm_position& o = a.anchor.position;
    return {
        {o.x + static_cast<double>(along.x), o.y + static_cast<double>(along.y), o.z + static_cast<double>(along.z)},
        {r.x, r.y, r.z, r.w}};
}

frm_twist body_twist(const Attachment& a, const frm_pose& device, const frm_twist& twist) {
    const Rotation<float> r = turn(plain(a.anchor.rotation));
    const Vec3f angular = r.to_world(plain(twist.angular));
    const Vec3f linear = r.to_world(plain(twist.linear)) * a.motion_scale + cross(angular, lever(a, device));
    return {plain(linear), plain(angular)};
}

Wrench about_grip(const Vec3f& arm, const Wrench& on_body) {
    return {on_body.force, on_body.torque + cross(arm, on_body.force)};
}

frm_wrench in_device(const Attachment& a, const frm_wrench& in_world) {
    const Rotation<float> r = turn(plain(a.anchor.rotation));
    return {plain(r.to_body(plain(in_world.force))), plain(r.to_body(plain(in_world.torque)))};
}

}  // namespace frm::device
