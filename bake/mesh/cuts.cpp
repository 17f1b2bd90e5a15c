#include "bake/mesh/cuts.h"

#include <algorithm>
#include <cmath>

#include "bake/mesh/adjacency.h"
#include "bake/mesh/shells.h"
#include "bake/mesh/tree.h"

namespace frm::bake {

namespace {

constexpr double kMargin = 1e-6;       // over the size: what repair() joins anyway
constexpr std::size_t kLookedAt = 16;  // of pairs that cut when they are nudged
/// By which shells are moved, over the size, to see whether they cut where all their edges meet edges; what is not deeper
/// than some of it in another is taken for touching it.
constexpr double kNudge = 1e-5, kDeep = 4 * kNudge, kOffEdge = 0.05 * kNudge;
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

    /// `deep`: how far the ends must be from the plane; `inside`: how far from the edges the line must pass.
    bool is_crossed(const Vec3d& from, const Vec3d& to, double deep, double inside) const {
        const double a = dot(from - corner[0], normal), b = dot(to - corner[0], normal);
        if (!((a > deep && b < -deep) || (a < -deep && b > deep))) return false;
        const Vec3d p = from + (to - from) * (a / (a - b));
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3d side = corner[(i + 1) % 3] - corner[i];
            if (!(dot(p - corner[i], cross(normal, side)) > inside * length(side))) return false;
        }
        return true;
    }
};

bool edges_cross(const std::vector<Vec3d>& vertices, const Triangle& edges_of, const Triangle& other, double deep,
                 double inside) {
    const Plate plate(vertices, other);
    if (plate.flat) return false;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t from = edges_of[i], to = edges_of[(i + 1) % 3];
        if (shares(other, from) || shares(other, to)) continue;
        if (plate.is_crossed(vertices[from], vertices[to], deep, inside)) return true;
    }
    return false;
}

}  // namespace

bool triangles_cut(const std::vector<Vec3d>& vertices, const Triangle& a, const Triangle& b, double margin) {
    return edges_cross(vertices, a, b, margin, margin) || edges_cross(vertices, b, a, margin, margin);
}

namespace {

/// With each shell moved its own way: of pieces that are each other's mirror images edges meet edges all round, and none
/// passes through the inside of a triangle.
Surface nudged(Surface surface, const std::vector<std::uint32_t>& shell, double by) {
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (std::uint32_t& corner : surface.triangles[t]) {
            const double way = shell[t];
            surface.vertices.push_back(surface.vertices[corner] +
                                       Vec3d{std::cos(way), std::sin(1.7 * way), std::cos(2.3 * way)} * by);
            corner = static_cast<std::uint32_t>(surface.vertices.size() - 1);
        }
    return surface;
}

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

/// With `between`, only triangles of two shells, and the first few pairs of them.
Cuts search(const Surface& surface, const std::vector<std::uint32_t>& shell, double deep, double inside,
            Pairs* between) {
    Cuts result;
    const Tree tree(surface.vertices, surface.triangles);

    std::size_t pairs = 0;
    std::uint32_t first_within = 0, first_between = 0;
    for (const std::uint32_t t : tree.order()) {
        tree.in_box(tree.box_of(t), [&](std::uint32_t u) {
            if (u <= t || (between && shell[t] == shell[u])) return true;
            if (++pairs > kMostPairs) return false;
            const Triangle &a = surface.triangles[t], &b = surface.triangles[u];
            if (!edges_cross(surface.vertices, a, b, deep, inside) &&
                !edges_cross(surface.vertices, b, a, deep, inside))
                return true;
            const bool same = shell[t] == shell[u];
            if (between && between->size() < kLookedAt) between->push_back({t, u});
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

/// Whether a corner of `t` lies inside the shell of `u` and not on it: pieces that lie against each other would else be taken,
/// nudged, for pieces that cut.
bool has_corner_inside(const Surface& surface, const std::vector<std::uint32_t>& shell, std::uint32_t t,
                       std::uint32_t u, double deep) {
    Surface piece;
    piece.vertices = surface.vertices;
    for (std::size_t k = 0; k < surface.triangles.size(); ++k)
        if (shell[k] == shell[u]) piece.triangles.push_back(surface.triangles[k]);
    const Vec3d aside = Vec3d{0.53, 0.62, 0.58} * deep;
    for (int k = 0; k < 3; ++k) {
        const Vec3d corner = surface.corner(t, k);
        if (winding(piece, corner + aside) > 0.9 && winding(piece, corner - aside) > 0.9) return true;
    }
    return false;
}

}  // namespace

Cuts find_cuts(const Surface& surface) {
    const double size = longest_side(measure(surface));
    std::vector<std::uint32_t> shell;
    const std::size_t shells = find_shells(find_neighbours(surface, "find_cuts"), shell);
    Cuts result = search(surface, shell, kMargin * size, kMargin * size, nullptr);
    if (shells > 1 && result.between == 0) {
        Pairs pairs;
        const Cuts moved = search(nudged(surface, shell, kNudge * size), shell, kDeep * size, kOffEdge * size, &pairs);
        if (std::any_of(pairs.begin(), pairs.end(), [&](const auto& pair) {
                return has_corner_inside(surface, shell, pair[0], pair[1], kDeep * size) ||
                       has_corner_inside(surface, shell, pair[1], pair[0], kDeep * size);
            }))
            result.between = moved.between, result.between_at = moved.between_at;
        result.complete = result.complete && moved.complete;
    }
    return result;
}

}  // namespace frm::bake
