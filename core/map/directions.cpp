#include "core/map/directions.h"

#include <cmath>
#include <cstdlib>

namespace frm {

// Points before row i: rows of |i'| = a hold 4 (n - a) points, 1 for a = n. Within a row, columns j hold two points (k
// < 0 first), one at both ends.
std::uint32_t DirectionSet::index_of(std::int32_t i, std::int32_t j, std::int32_t k) const {
    const std::int32_t m = n_ - std::abs(i);
    std::int32_t before = 0;
    if (i > -n_) {
        const std::int32_t rows = i + n_ - 1;  // full rows between the first point and this one
        const std::int32_t lower = rows < n_ ? rows : n_;
        before = 1 + 2 * lower * (lower + 1);  // sizes 4, 8, ... up to row 0
        const std::int32_t upper = rows - lower;
        before += 4 * (upper * n_ - upper * (upper + 1) / 2);  // sizes 4 (n - 1), 4 (n - 2), ...
    }
    if (m == 0) return static_cast<std::uint32_t>(before);
    const std::int32_t column = j + m;
    const std::int32_t in_row = column == 0 ? 0 : 1 + 2 * (column - 1) + (column < 2 * m && k > 0 ? 1 : 0);
    return static_cast<std::uint32_t>(before + in_row);
}

std::array<std::int32_t, 3> DirectionSet::point(std::uint32_t index) const {
    std::uint32_t at = 0;
    for (std::int32_t i = -n_; i <= n_; ++i) {
        const std::int32_t m = n_ - std::abs(i);
        const std::uint32_t row = m == 0 ? 1u : static_cast<std::uint32_t>(4 * m);
        if (index >= at + row) {
            at += row;
            continue;
        }
        for (std::int32_t j = -m; j <= m; ++j) {
            const std::int32_t k = m - std::abs(j);
            const std::uint32_t here = k == 0 ? 1u : 2u;
            if (index < at + here) return {i, j, index == at && k != 0 ? -k : k};
            at += here;
        }
    }
    return {0, 0, 0};
}

Vec3d DirectionSet::direction(std::uint32_t index) const {
    const auto [i, j, k] = point(index);
    const Vec3d p(i, j, k);
    return p / length(p);
}

Neighbours DirectionSet::earlier_neighbours(std::uint32_t index) const {
    const auto here = point(index);
    Neighbours out;
    for (std::size_t same = 0; same < 3; ++same) {
        for (int signs = 0; signs < 4; ++signs) {
            auto p = here;
            p[(same + 1) % 3] += signs & 1 ? 1 : -1;
            p[(same + 2) % 3] += signs & 2 ? 1 : -1;
            if (std::abs(p[0]) + std::abs(p[1]) + std::abs(p[2]) != n_) continue;
            const std::uint32_t found = index_of(p[0], p[1], p[2]);
            if (found < index) out.index[out.count++] = found;
        }
    }
    return out;
}

// Faces by octant (bits: x, y, z negative), then row i, then j; where both are, the one with its corner (i, j, k) inwards
// before the one with its edge. Rows have 2 (n - i) - 1 faces, so that i (2 n - i) are before row i.
std::array<std::uint32_t, 3> DirectionSet::corners(std::uint32_t face) const {
    const auto in_octant = static_cast<std::uint32_t>(n_ * n_);
    const std::uint32_t octant = face / in_octant;
    auto rest = static_cast<std::int32_t>(face % in_octant);
    std::int32_t i = 0;
    while (rest >= 2 * (n_ - i) - 1) rest -= 2 * (n_ - i++) - 1;
    const std::int32_t j = rest / 2;
    const bool edge = rest % 2 != 0;
    const std::int32_t k = n_ - i - j - (edge ? 2 : 1);
    const std::int32_t sx = octant & 4 ? -1 : 1, sy = octant & 2 ? -1 : 1, sz = octant & 1 ? -1 : 1;
    const auto at = [&](std::int32_t p, std::int32_t q, std::int32_t r) { return index_of(sx * p, sy * q, sz * r); };
    if (edge) return {at(i, j + 1, k + 1), at(i + 1, j, k + 1), at(i + 1, j + 1, k)};
    return {at(i + 1, j, k), at(i, j + 1, k), at(i, j, k + 1)};
}

FacePlace DirectionSet::locate(const Vec3f& d) const {
    const float ax = std::fabs(d.x), ay = std::fabs(d.y), az = std::fabs(d.z);
    const float n = static_cast<float>(n_), last = n - 1, sum = (ax + ay) + az, size = sum > 0 ? sum : 1.0f;
    const float p = ax / size * n, q = ay / size * n;
    const auto i = static_cast<std::int32_t>(p < last ? p : last);
    const float room = last - static_cast<float>(i);
    const auto j = static_cast<std::int32_t>(q < room ? q : room);
    const float fp = p - static_cast<float>(i), fq = q - static_cast<float>(j), both = fp + fq;
    const bool inner = static_cast<float>(j) < room && both > 1;
    const float rest = inner ? both - 1 : 1 - both;
    const std::int32_t octant = (d.x < 0 ? 4 : 0) + (d.y < 0 ? 2 : 0) + (d.z < 0 ? 1 : 0);
    return {static_cast<std::uint32_t>(octant * n_ * n_ + i * (2 * n_ - i) + 2 * j + (inner ? 1 : 0)),
            {inner ? 1 - fp : fp, inner ? 1 - fq : fq, rest > 0 ? rest : 0.0f}};
}

DirectionWeights DirectionSet::interpolate(const Vec3f& d) const {
    const float n = static_cast<float>(n_);
    const float ax = std::fabs(d.x), ay = std::fabs(d.y), az = std::fabs(d.z);
    const float s = n / (ax + ay + az);
    const float a = ax * s;
    const float b = ay * s;
    float c = n - a - b;
    if (c < 0) c = 0;
    const std::int32_t i = a < n ? static_cast<std::int32_t>(a) : n_;
    const std::int32_t room = n_ - i;
    const std::int32_t j = b < static_cast<float>(room) ? static_cast<std::int32_t>(b) : room;
    const float fa = a - static_cast<float>(i);
    const float fb = b - static_cast<float>(j);
    const std::int32_t c_room = room - j;
    std::int32_t k = c < static_cast<float>(c_room) ? static_cast<std::int32_t>(c) : c_room;
    if (c_room - k > 2) k = c_room - 2;
    const std::int32_t sx = d.x < 0 ? -1 : 1, sy = d.y < 0 ? -1 : 1, sz = d.z < 0 ? -1 : 1;
    const auto at = [&](std::int32_t p, std::int32_t q, std::int32_t r) { return index_of(sx * p, sy * q, sz * r); };

    const std::int32_t octant = (sx < 0 ? 4 : 0) + (sy < 0 ? 2 : 0) + (sz < 0 ? 1 : 0);
    const auto face = static_cast<std::uint32_t>(octant * n_ * n_ + i * (2 * n_ - i) + 2 * j);

    DirectionWeights out{};
    switch (c_room - k) {
        case 0:
            out = {{at(i, j, k), at(i, j, k), at(i, j, k)}, {1, 0, 0}, 0};
            break;
        case 1:
            out = {{at(i + 1, j, k), at(i, j + 1, k), at(i, j, k + 1)}, {fa, fb, 1 - fa - fb}, face};
            break;
        default:
            out = {{at(i, j + 1, k + 1), at(i + 1, j, k + 1), at(i + 1, j + 1, k)},
                   {1 - fa, 1 - fb, fa + fb - 1},
                   face + 1};
            break;
    }
    // Rounding can leave the third weight a little below zero.
    if (out.weight[2] < 0) {
        out.weight[2] = 0;
        const float sum = out.weight[0] + out.weight[1];
        out.weight[0] /= sum;
        out.weight[1] /= sum;
    }
    return out;
}

}  // namespace frm
