// 3x3 matrices of double: rotations, reflections and second moments.
#pragma once

#include <array>
#include <cmath>

#include "core/math/vec.h"

namespace frm::bake {

struct Matrix3 {
    std::array<Vec3d, 3> row{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};  ///< the identity, unless said otherwise

    Vec3d column(int i) const { return {row[0][i], row[1][i], row[2][i]}; }
};

inline Vec3d operator*(const Matrix3& m, const Vec3d& v) {
    return {dot(m.row[0], v), dot(m.row[1], v), dot(m.row[2], v)};
}

inline Matrix3 transpose(const Matrix3& m) { return {{m.column(0), m.column(1), m.column(2)}}; }

inline Matrix3 operator*(const Matrix3& a, const Matrix3& b) {
    const Matrix3 t = transpose(b);
    return {{t * a.row[0], t * a.row[1], t * a.row[2]}};
}

inline Matrix3 operator*(const Matrix3& m, double s) { return {{m.row[0] * s, m.row[1] * s, m.row[2] * s}}; }

inline Matrix3 operator+(const Matrix3& a, const Matrix3& b) {
    return {{a.row[0] + b.row[0], a.row[1] + b.row[1], a.row[2] + b.row[2]}};
}

inline double determinant(const Matrix3& m) { return dot(m.row[0], cross(m.row[1], m.row[2])); }

/// Turns by `angle` (radians, counter-clockwise seen from the tip) about the unit vector `axis` (Rodrigues).
inline Matrix3 rotation_about(const Vec3d& axis, double angle) {
    const double c = std::cos(angle), s = std::sin(angle);
    const Matrix3 turn{{Vec3d{0, -axis.z, axis.y}, Vec3d{axis.z, 0, -axis.x}, Vec3d{-axis.y, axis.x, 0}}};
    Matrix3 result = turn * s + Matrix3{} * c;
    for (int i = 0; i < 3; ++i) result.row[static_cast<std::size_t>(i)] += axis * (axis[i] * (1 - c));
    return result;
}

/// Mirrors in the plane through the origin across the unit vector `normal`.
inline Matrix3 mirror_across(const Vec3d& normal) {
    Matrix3 result;
    for (int i = 0; i < 3; ++i) result.row[static_cast<std::size_t>(i)] -= normal * (2 * normal[i]);
    return result;
}

/// A unit vector across the unit vector `axis`, always the same one for the same axis.
inline Vec3d any_across(const Vec3d& axis) {
    int smallest = 0;
    for (int i = 1; i < 3; ++i) {
        // A margin, so that rounding does not choose between components that are meant to be equal.
        if (std::fabs(axis[i]) < std::fabs(axis[smallest]) - 1e-9) smallest = i;
    }
    Vec3d v;
    v[smallest] = 1;
    v -= axis * axis[smallest];
    return v / length(v);
}

}  // namespace frm::bake
