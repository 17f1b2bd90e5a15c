#include "core/api/axes.h"

#include <cmath>

#include "core/error.h"

namespace frm::api {
namespace {

constexpr float half_root = 0.70710678f;

bool within(const frm_vec3& v, float limit) {
    return std::fabs(v.x) <= limit && std::fabs(v.y) <= limit && std::fabs(v.z) <= limit;  // false for NaN
}

}  // namespace

Axes::Axes(std::uint32_t axes) : axes_(axes) {
    const auto set = [&](int x, int y, int z, float hand, Quat<float> world, Quat<float> body) {
        from_[0] = x, from_[1] = y, from_[2] = z;
        hand_ = hand;
        world_ = world;
        body_ = body;
    };
    switch (axes) {
        case FRM_AXES_Y_UP_RIGHT:
            set(2, 0, 1, 1, {0.5f, 0.5f, 0.5f, 0.5f}, {});
            break;
        case FRM_AXES_Y_UP_LEFT:
            set(0, 2, 1, -1, {0, half_root, -half_root, 0}, {1, 0, 0, 0});
            break;
        case FRM_AXES_Z_UP_LEFT:
            set(1, 0, 2, -1, {half_root, -half_root, 0, 0}, {0, half_root, -half_root, 0});
            break;
        default:
            break;
    }
}

Vec3f Axes::mirror(const Vec3f& v) const {
    switch (axes_) {
        case FRM_AXES_Y_UP_LEFT:
            return {-v.x, v.y, v.z};
        case FRM_AXES_Z_UP_LEFT:
            return {v.x, v.z, v.y};
        default:
            return v;
    }
}

std::array<double, 36> Axes::matrix_out(const std::array<double, 36>& m) const {
    std::array<double, 36> out;
    const auto host = [&](std::size_t i) { return i - i % 3 + static_cast<std::size_t>(from_[i % 3]); };
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j)
            out[6 * host(i) + host(j)] = ((i < 3) != (j < 3) ? static_cast<double>(hand_) : 1.0) * m[6 * i + j];
    return out;
}

Pose Axes::pose_in(const frm_pose& pose, const char* what) const {
    const frm_position& p = pose.position;
    if (!(std::fabs(p.x) <= 1e9 && std::fabs(p.y) <= 1e9 && std::fabs(p.z) <= 1e9))
        throw Error(FRM_ERROR_ARGUMENT, "%s.position is not finite or beyond 1e9 m", what);
    const frm_quaternion& r = pose.rotation;
    const float squared = r.x * r.x + r.y * r.y + r.z * r.z + r.w * r.w;
    if (!(squared > 1e-12f && squared < 1e12f))
        throw Error(FRM_ERROR_ARGUMENT, "%s.rotation is not finite, or its length is not between 1e-6 and 1e6", what);
    const float norm = std::sqrt(squared);
    Quat<float> q{r.x / norm, r.y / norm, r.z / norm, r.w / norm};
    if (axes_ != FRM_AXES_Z_UP_RIGHT) q = world_ * q * conjugate(body_);
    return {position_in(p), q};
}

Twist Axes::twist_in(const frm_twist& twist, const char* what) const {
    if (!within(twist.linear, 1e4f)) throw Error(FRM_ERROR_ARGUMENT, "%s.linear is not finite or beyond 1e4 m/s", what);
    if (!within(twist.angular, 1e4f))
        throw Error(FRM_ERROR_ARGUMENT, "%s.angular is not finite or beyond 1e4 rad/s", what);
    return {vector_in(twist.linear), axial_in(twist.angular)};
}

frm_pose Axes::pose_out(const Pose& pose) const {
    Quat<float> q = pose.rotation;
    if (axes_ != FRM_AXES_Z_UP_RIGHT) q = conjugate(world_) * q * body_;
    return {position_out(pose.position), {q.x, q.y, q.z, q.w}};
}

}  // namespace frm::api
