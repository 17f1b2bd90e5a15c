// Closed, outward-oriented surfaces to test with. Header only; sizes in metres, every shape is centred on the origin.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "bake/mesh/surface.h"
#include "core/math/vec.h"

namespace frm::test {

using bake::Surface;

/// A box of the given edge lengths. Triangles 2 k and 2 k + 1 are face k, in the order -x +x -y +y -z +z.
inline Surface box(const Vec3d& size) {
    Surface s;
    for (int i = 0; i < 8; ++i) {
        s.vertices.push_back({((i & 1) != 0 ? 0.5 : -0.5) * size.x, ((i & 2) != 0 ? 0.5 : -0.5) * size.y,
                              ((i & 4) != 0 ? 0.5 : -0.5) * size.z});
    }
    s.triangles = {{0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
                   {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}};
    return s;
}

/// An icosahedron whose triangles are split in four `subdivisions` times, corners on the sphere: 20 * 4^subdivisions
/// triangles.
inline Surface icosphere(double radius, int subdivisions) {
    const double g = 0.5 * (1 + std::sqrt(5.0));
    Surface s;
    s.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                  {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
    s.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                   {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                   {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
    for (int level = 0; level < subdivisions; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto key = a < b ? std::make_pair(a, b) : std::make_pair(b, a);
            const auto found = middles.find(key);
            if (found != middles.end()) return found->second;
            const auto index = static_cast<std::uint32_t>(s.vertices.size());
            s.vertices.push_back((s.vertices[a] + s.vertices[b]) * 0.5);
            middles.emplace(key, index);
            return index;
        };
        std::vector<bake::Triangle> finer;
        finer.reserve(4 * s.triangles.size());
        for (const bake::Triangle& t : s.triangles) {
            const std::uint32_t a = middle(t[0], t[1]), b = middle(t[1], t[2]), c = middle(t[2], t[0]);
            finer.push_back({t[0], a, c});
            finer.push_back({a, t[1], b});
            finer.push_back({c, b, t[2]});
            finer.push_back({a, b, c});
        }
        s.triangles = std::move(finer);
    }
    for (Vec3d& v : s.vertices) v = v * (radius / length(v));
    return s;
}

/// A cylinder along z with flat ends; `segments` sides, corners on the circle.
inline Surface cylinder(double radius, double length, int segments) {
    const double pi = 3.14159265358979323846;
    const auto n = static_cast<std::uint32_t>(segments);
    Surface s;
    for (int end = 0; end < 2; ++end) {
        for (std::uint32_t i = 0; i < n; ++i) {
            const double angle = 2 * pi * i / segments;
            s.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), (end - 0.5) * length});
        }
    }
    s.vertices.push_back({0, 0, -0.5 * length});
    s.vertices.push_back({0, 0, 0.5 * length});
    for (std::uint32_t i = 0; i < n; ++i) {
        const std::uint32_t j = (i + 1) % n;
        s.triangles.push_back({i, j, n + j});
        s.triangles.push_back({i, n + j, n + i});
        s.triangles.push_back({2 * n, j, i});
        s.triangles.push_back({2 * n + 1, n + i, n + j});
    }
    return s;
}

/// v turned about an axis (any length but zero) by an angle in radians, counter-clockwise seen from the axis' tip
/// (Rodrigues).
inline Vec3d rotated(const Vec3d& v, const Vec3d& axis, double angle) {
    const Vec3d k = axis / length(axis);
    const double c = std::cos(angle), s = std::sin(angle);
    return v * c + cross(k, v) * s + k * (dot(k, v) * (1 - c));
}

inline Surface rotated(Surface surface, const Vec3d& axis, double angle) {
    for (Vec3d& v : surface.vertices) v = rotated(v, axis, angle);
    return surface;
}

inline Surface moved(Surface surface, const Vec3d& by) {
    for (Vec3d& v : surface.vertices) v += by;
    return surface;
}

inline Surface joined(Surface a, const Surface& b) {
    const auto base = static_cast<std::uint32_t>(a.vertices.size());
    a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
    for (const bake::Triangle& t : b.triangles) a.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    return a;
}

inline Surface inside_out(Surface s) {
    for (bake::Triangle& t : s.triangles) std::swap(t[1], t[2]);
    return s;
}

}  // namespace frm::test
