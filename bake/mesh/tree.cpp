#include "bake/mesh/tree.h"

#include <algorithm>
#include <limits>
#include <numeric>

namespace frm::bake {

namespace {

void grow(Box& box, const Box& by) {
    for (int i = 0; i < 3; ++i) {
        box.low[i] = std::min(box.low[i], by.low[i]);
        box.high[i] = std::max(box.high[i], by.high[i]);
    }
}

double squared_distance_to(const Box& box, const Vec3d& p) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
        const double outside = std::max({box.low[i] - p[i], p[i] - box.high[i], 0.0});
        sum += outside * outside;
    }
    return sum;
}

}  // namespace

// Which corner, edge or face of the triangle is nearest, by the signs of areas (Ericson, Real-Time Collision Detection,
// 5.1.5). A triangle without area ends at one of its edges.
double squared_distance(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& p) {
    const auto squared = [](const Vec3d& v) { return dot(v, v); };
    const Vec3d ab = b - a, ac = c - a, ap = p - a, bp = p - b, cp = p - c;
    const double d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return squared(ap);
    const double d3 = dot(ab, bp), d4 = dot(ac, bp);
    if (d3 >= 0 && d4 <= d3) return squared(bp);
    const double vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return squared(ap - ab * (d1 > d3 ? d1 / (d1 - d3) : 0));
    const double d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d6 >= 0 && d5 <= d6) return squared(cp);
    const double vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return squared(ap - ac * (d2 > d6 ? d2 / (d2 - d6) : 0));
    const double va = d3 * d6 - d5 * d4, along = d4 - d3, back = d5 - d6;
    if (va <= 0 && along >= 0 && back >= 0)
        return squared(bp - (c - b) * (along + back > 0 ? along / (along + back) : 0));
    const double all = 1 / (va + vb + vc);
    return squared(ap - ab * (vb * all) - ac * (vc * all));
}

Tree::Tree(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& triangles)
    : vertices_(vertices), triangles_(triangles), order_(triangles.size()) {
    if (triangles.empty()) return;
    std::iota(order_.begin(), order_.end(), 0u);
    std::vector<Vec3d> middle(triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        const Box box = box_of(t);
        middle[t] = (box.low + box.high) * 0.5;
    }

    struct Range {
        std::uint32_t node, from, to;
    };
    std::vector<Range> ranges = {{0, 0, static_cast<std::uint32_t>(triangles.size())}};
    nodes_.resize(1);
    while (!ranges.empty()) {
        const auto [node, from, to] = ranges.back();
        ranges.pop_back();
        Box box = box_of(order_[from]);
        Vec3d low = middle[order_[from]], high = low;
        for (std::uint32_t i = from + 1; i < to; ++i) {
            grow(box, box_of(order_[i]));
            const Vec3d& m = middle[order_[i]];
            for (int k = 0; k < 3; ++k) {
                low[k] = std::min(low[k], m[k]);
                high[k] = std::max(high[k], m[k]);
            }
        }
        nodes_[node].box = box;
        if (to - from <= kLeaf) {
            nodes_[node].left = from;
            nodes_[node].count = to - from;
            continue;
        }
        int widest = 0;
        for (int k = 1; k < 3; ++k) {
            if (high[k] - low[k] > high[widest] - low[widest]) widest = k;
        }
        const std::uint32_t half = from + (to - from) / 2;
        // Equal middles by number: the same tree from every standard library.
        std::nth_element(order_.begin() + from, order_.begin() + half, order_.begin() + to,
                         [&](std::uint32_t a, std::uint32_t b) {
                             const double x = middle[a][widest], y = middle[b][widest];
                             return x < y || (x == y && a < b);
                         });
        const auto left = static_cast<std::uint32_t>(nodes_.size());
        nodes_[node].left = left;
        nodes_.resize(nodes_.size() + 2);
        ranges.push_back({left + 1, half, to});
        ranges.push_back({left, from, half});
    }
}

double Tree::squared_distance(const Vec3d& point, double most) const {
    if (nodes_.empty()) return most;
    struct Waiting {
        std::uint32_t node;
        double distance;
    };
    Waiting stack[64];
    std::size_t waiting = 0;
    stack[waiting++] = {0, squared_distance_to(nodes_[0].box, point)};
    while (waiting > 0) {
        const Waiting next = stack[--waiting];
        if (!(next.distance < most)) continue;
        const Node& node = nodes_[next.node];
        if (node.count == 0) {
            const Waiting left{node.left, squared_distance_to(nodes_[node.left].box, point)};
            const Waiting right{node.left + 1, squared_distance_to(nodes_[node.left + 1].box, point)};
            const bool left_first = left.distance <= right.distance;
            stack[waiting++] = left_first ? right : left;
            stack[waiting++] = left_first ? left : right;
            continue;
        }
        for (std::uint32_t i = 0; i < node.count; ++i) {
            const Triangle& t = triangles_[order_[node.left + i]];
            most =
                std::min(most, frm::bake::squared_distance(vertices_[t[0]], vertices_[t[1]], vertices_[t[2]], point));
        }
    }
    return most;
}

Box Tree::box_of(std::uint32_t triangle) const {
    const Triangle& t = triangles_[triangle];
    Box box{vertices_[t[0]], vertices_[t[0]]};
    grow(box, {vertices_[t[1]], vertices_[t[1]]});
    grow(box, {vertices_[t[2]], vertices_[t[2]]});
    return box;
}

bool Tree::meets_ray(const Box& box, const Vec3d& origin, const Vec3d& direction) {
    double from = 0, to = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        if (direction[i] == 0) {
            if (origin[i] < box.low[i] || origin[i] > box.high[i]) return false;
            continue;
        }
        double a = (box.low[i] - origin[i]) / direction[i];
        double b = (box.high[i] - origin[i]) / direction[i];
        if (a > b) std::swap(a, b);
        from = std::max(from, a);
        to = std::min(to, b);
    }
    // Boxes of triangles may be flat; rounding must not lose the triangle in one.
    return from <= to + 1e-12 * (1 + std::fabs(to));
}

}  // namespace frm::bake
