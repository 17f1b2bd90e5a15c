// A box tree over triangles: which of them are near a box, a point or on a line, without looking at all.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/mesh/surface.h"

namespace frm::bake {

struct Box {
    Vec3d low, high;

    bool meets(const Box& other) const {
        return low.x <= other.high.x && other.low.x <= high.x && low.y <= other.high.y && other.low.y <= high.y &&
               low.z <= other.high.z && other.low.z <= high.z;
    }
};

/// Squared distance from a point to the triangle a, b, c.
double squared_distance(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& point);

/// Keeps references: vertices and triangles must outlive it. Finite coordinates only.
class Tree {
public:
    Tree(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& triangles);

    /// Calls visit(triangle) for each triangle whose box meets `box`; ends when it returns false.
    template <typename Visit>
    void in_box(const Box& box, Visit visit) const {
        walk([&](const Box& b) { return b.meets(box); }, visit);
    }

    /// As in_box, for the half-line from `origin` along `direction`.
    template <typename Visit>
    void on_ray(const Vec3d& origin, const Vec3d& direction, Visit visit) const {
        walk([&](const Box& b) { return meets_ray(b, origin, direction); }, visit);
    }

    /// Squared distance from the point to the nearest triangle, or `most` if none is nearer than that.
    double squared_distance(const Vec3d& point, double most) const;

    Box box_of(std::uint32_t triangle) const;
    /// All triangles, neighbours in space close together: walking them in this order keeps the caches warm.
    const std::vector<std::uint32_t>& order() const { return order_; }

private:
    static constexpr std::uint32_t kLeaf = 4;  // triangles at most

    // Children of an inner node are `left` and `left` + 1; a leaf has `count` triangles from order_[left] on.
    struct Node {
        Box box;
        std::uint32_t left = 0, count = 0;
    };

    static bool meets_ray(const Box& box, const Vec3d& origin, const Vec3d& direction);

    template <typename Test, typename Visit>
    void walk(Test test, Visit visit) const {
        if (nodes_.empty()) return;
        std::uint32_t stack[64] = {0};  // halving 2^32 triangles takes 32 levels
        std::size_t waiting = 1;
        while (waiting > 0) {
            const Node& node = nodes_[stack[--waiting]];
            if (!test(node.box)) continue;
            if (node.count == 0) {
                stack[waiting++] = node.left + 1;
                stack[waiting++] = node.left;
                continue;
            }
            for (std::uint32_t i = 0; i < node.count; ++i) {
                const std::uint32_t t = order_[node.left + i];
                if (test(box_of(t)) && !visit(t)) return;
            }
        }
    }

    const std::vector<Vec3d>& vertices_;
    const std::vector<Triangle>& triangles_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace frm::bake
