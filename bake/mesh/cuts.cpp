#include "bake/mesh/cuts.h"

#include <algorithm>

#include "bake/mesh/adjacency.h"
#include "bake/mesh/tree.h"

namespace frm::bake {

namespace {

constexpr double kMargin = 1e-6;                // over the size: what repair() joins anyway
constexpr std::size_t kMostPairs = 50'000'000;  // of triangles whose boxes meet; a sound mesh of N has some 10 N

bool shares(const Triangle& t, std::uint32_t v) { return t[0] == v || t[1] == v || t[2] == v; }

// The plane of a triangle, and whether a line passes through the triangle.
struct Plate {
    std::array<Vec3d, 3> corner;
    Vec3d normal;       // unit
    bool flat = false;  // no area, so no plane

    Plate(const std::vector<Vec3d>& vertices, const Triangle& t)
        : corner{vertices[t[0]], vertices[t[1]], vertices[t[2]]} {
        const Vec3d n = cross(corner[1] - corner[0], corner[2] - corner[0]);
        const double norm = length(n);
        flat = !(norm > 0);
        if (!flat) normal = n / norm;
    }

    bool is_crossed(const Vec3d& from, const Vec3d& to, double margin) const {
        const double a = dot(from - corner[0], normal), b = dot(to - corner[0], normal);
        if (!((a > margin && b < -margin) || (a < -margin && b > margin))) return false;
        const Vec3d p = from + (to - from) * (a / (a - b));
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3d side = corner[(i + 1) % 3] - corner[i];
            if (!(dot(p - corner[i], cross(normal, side)) > margin * length(side))) return false;
        }
        return true;
    }
};

bool edges_cross(const std::vector<Vec3d>& vertices, const Triangle& edges_of, const Triangle& other, double margin) {
    const Plate plate(vertices, other);
    if (plate.flat) return false;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t from = edges_of[i], to = edges_of[(i + 1) % 3];
        if (shares(other, from) || shares(other, to)) continue;
        if (plate.is_crossed(vertices[from], vertices[to], margin)) return true;
    }
    return false;
}

}  // namespace

bool triangles_cut(const std::vector<Vec3d>& vertices, const Triangle& a, const Triangle& b, double margin) {
    return edges_cross(vertices, a, b, margin) || edges_cross(vertices, b, a, margin);
}

Cuts find_cuts(const Surface& surface) {
    Cuts result;
    const SurfaceProperties shape = measure(surface);
    const Vec3d extent = shape.high - shape.low;
    const double margin = kMargin * std::max({extent.x, extent.y, extent.z});
    std::vector<std::uint32_t> shell;
    find_shells(find_neighbours(surface, "find_cuts"), shell);
    const Tree tree(surface.vertices, surface.triangles);

    std::size_t pairs = 0;
    std::uint32_t first_within = 0, first_between = 0;
    for (const std::uint32_t t : tree.order()) {
        tree.in_box(tree.box_of(t), [&](std::uint32_t u) {
            if (u <= t) return true;
            if (++pairs > kMostPairs) return false;
            if (!triangles_cut(surface.vertices, surface.triangles[t], surface.triangles[u], margin)) return true;
            const bool same = shell[t] == shell[u];
            std::size_t& count = same ? result.within : result.between;
            std::uint32_t& first = same ? first_within : first_between;
            if (count++ == 0 || t < first) {
                first = t;
                (same ? result.within_at : result.between_at) = surface.corner(t, 0);
            }
            return true;
        });
        if (pairs > kMostPairs) {
            result.complete = false;
            break;
        }
    }
    return result;
}

}  // namespace frm::bake
