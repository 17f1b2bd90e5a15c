#include "device/spidar_g/geometry.h"

#include <cmath>

namespace frm::spidar_g {

bool string_rows(const Geometry& geometry, const GripPose& pose, StringRows& rows) {
    const Rotation<double> rotation(pose.rotation);
    for (int i = 0; i < string_count; ++i) {
        const Fastening& string = geometry.strings[static_cast<std::size_t>(i)];
        const Vec3d arm = rotation.to_world(string.attachment);
        const Vec3d way = string.anchor - arm - pose.position;
        const double l = length(way);
        if (!(l > 1e-6 && l < 1e3)) return false;
        const Vec3d u = way / l, turn = cross(arm, u) / geometry.lever;
        rows.length[static_cast<std::size_t>(i)] = l;
        for (int k = 0; k < 3; ++k) {
            rows.row[i][k] = u[k];
            rows.row[i][3 + k] = turn[k];
        }
    }
    return true;
}

GripWrench wrench_of(const StringRows& rows, const Tensions& tensions, double lever) {
    double w[6] = {};
    for (int i = 0; i < string_count; ++i)
        for (int k = 0; k < 6; ++k) w[k] += rows.row[i][k] * tensions[static_cast<std::size_t>(i)];
    return {{w[0], w[1], w[2]}, Vec3d(w[3], w[4], w[5]) * lever};
}

namespace {

Quat<double> normalised(const Quat<double>& q) {
    const double n = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {q.x / n, q.y / n, q.z / n, q.w / n};
}

}  // namespace

Quat<double> turned(const Quat<double>& rotation, const Vec3d& vector) {
    const Quat<double> step{vector.x / 2, vector.y / 2, vector.z / 2, 1};
    return normalised(step * rotation);
}

Vec3d rotation_between(const Quat<double>& before, const Quat<double>& after) {
    Quat<double> d = after * conjugate(before);
    if (d.w < 0) d = {-d.x, -d.y, -d.z, -d.w};
    // 2 atan(x) by its series to x^7; x is the tangent of half the angle.
    const Vec3d tangent = Vec3d(d.x, d.y, d.z) / (d.w > 1e-3 ? d.w : 1e-3);
    const double q = dot(tangent, tangent);
    if (q > 0.3) return tangent * 2.0;
    return tangent * (2 * (1 - q * (1.0 / 3 - q * (1.0 / 5 - q * (1.0 / 7)))));
}

}  // namespace frm::spidar_g
