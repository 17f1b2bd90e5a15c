// A triangle against the water surface, taken as flat within the triangle: the wet part, as triangles.
#pragma once

#include "core/math/vec.h"

namespace frm {

struct Corner {
    Vec3f at;     ///< local: world axes, origin at the body
    float depth;  ///< below the surface, m
};

/// Calls add(corner, corner, corner, share) for each wholly wet piece, `share` being its part of the triangle's area:
/// nothing, the triangle itself, or one or two pieces of it. Returns the number of wet corners.
template <typename Add>
int add_wet_part(const Corner corner[3], Add&& add) {
    const bool wet[3] = {corner[0].depth > 0, corner[1].depth > 0, corner[2].depth > 0};
    const int count = wet[0] + wet[1] + wet[2];
    if (count == 3) add(corner[0], corner[1], corner[2], 1.0f);
    if (count == 0 || count == 3) return count;

    int odd = 0;  // the corner that is alone on its side of the surface
    if (wet[0] == wet[1])
        odd = 2;
    else if (wet[0] == wet[2])
        odd = 1;
    const Corner &p = corner[odd], &q = corner[(odd + 1) % 3], &r = corner[(odd + 2) % 3];
    const float s = p.depth / (p.depth - q.depth), t = p.depth / (p.depth - r.depth);
    const Corner on_q{p.at + (q.at - p.at) * s, 0}, on_r{p.at + (r.at - p.at) * t, 0};
    if (wet[odd]) {
        add(p, on_q, on_r, s * t);
    } else {
        add(on_q, q, r, 1 - s);
        add(on_q, r, on_r, s * (1 - t));
    }
    return count;
}

inline Vec3f vector_area_of(const Vec3f& a, const Vec3f& b, const Vec3f& c) { return cross(b - a, c - a) * 0.5f; }

}  // namespace frm
