// Unit quaternions and the rotation matrices made from them.
#pragma once

#include "core/math/vec.h"

namespace frm {

template <typename T>
struct Quat {
    T x{}, y{}, z{}, w{1};
};

template <typename T>
constexpr Quat<T> operator*(const Quat<T>& a, const Quat<T>& b) {
    return {a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y, a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
            a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w, a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z};
}

template <typename T>
constexpr Quat<T> conjugate(const Quat<T>& q) {
    return {-q.x, -q.y, -q.z, q.w};
}

/// Rows of a rotation from the body's frame to the world's.
template <typename T>
struct Rotation {
    Vec3<T> row0{1, 0, 0}, row1{0, 1, 0}, row2{0, 0, 1};

    Rotation() = default;
    explicit Rotation(const Quat<T>& q) {
        const T xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
        const T wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
        row0 = {1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy)};
        row1 = {2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx)};
        row2 = {2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)};
    }

    Vec3<T> to_world(const Vec3<T>& v) const { return {dot(row0, v), dot(row1, v), dot(row2, v)}; }
    Vec3<T> to_body(const Vec3<T>& v) const { return row0 * v.x + row1 * v.y + row2 * v.z; }
};

}  // namespace frm
