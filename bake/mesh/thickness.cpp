#include "bake/mesh/thickness.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "bake/mesh/tree.h"

namespace frm::bake {

namespace {

constexpr std::size_t kPoints = 4096;            // a power of two
constexpr std::size_t kMostVisits = 50'000'000;  // of triangles near a line; a sound mesh has some 10 a line

struct Crossing {
    double distance;
    int step;  // +1 into a piece, -1 out of one
};

// How far below `from`, on triangle `own`, the shape ends; negative where the point lies inside another piece or the
// line leaves through an edge.
double depth(const Surface& surface, const Tree& tree, std::uint32_t own, const Vec3d& from, const Vec3d& inward,
             std::vector<Crossing>& crossings, std::size_t& visits) {
    crossings.clear();
    tree.on_ray(from, inward, [&](std::uint32_t t) {
        ++visits;
        if (t == own) return true;
        const Vec3d a = surface.corner(t, 0);
        const Vec3d e1 = surface.corner(t, 1) - a, e2 = surface.corner(t, 2) - a;
        const Vec3d normal = cross(e1, e2);
        const double slope = dot(normal, inward), square = dot(normal, normal);
        if (!(slope * slope > 1e-12 * square)) return true;
        const double distance = dot(a - from, normal) / slope;
        const Vec3d p = from + inward * distance - a;
        const double b1 = dot(cross(p, e2), normal) / square, b2 = dot(cross(e1, p), normal) / square;
        if (distance > 0 && b1 >= 0 && b2 >= 0 && b1 + b2 <= 1) crossings.push_back({distance, slope > 0 ? -1 : 1});
        return true;
    });
    std::sort(crossings.begin(), crossings.end(),
              [](const Crossing& a, const Crossing& b) { return a.distance < b.distance; });
    // Outside at the far end, so the steps tell how many pieces the line begins in: one, for a point on the skin.
    int pieces = 0;
    for (const Crossing& c : crossings) pieces -= c.step;
    if (pieces != 1) return -1;
    for (const Crossing& c : crossings) {
        pieces += c.step;
        if (pieces == 0) return c.distance;
    }
    return -1;
}

}  // namespace

Thickness measure_thickness(const Surface& surface) {
    const Tree tree(surface.vertices, surface.triangles);
    std::vector<double> area_to(surface.triangles.size());
    double area = 0;
    for (std::size_t t = 0; t < area_to.size(); ++t) {
        const Vec3d a = surface.corner(t, 0);
        area += 0.5 * length(cross(surface.corner(t, 1) - a, surface.corner(t, 2) - a));
        area_to[t] = area;
    }

    std::vector<std::pair<double, std::size_t>> depths;
    std::vector<Vec3d> points(kPoints);
    std::vector<Crossing> crossings;
    std::size_t visits = 0;
    for (std::size_t k = 0; k < kPoints && visits < kMostVisits; ++k) {
        // An odd step meets every point, and those first met are spread over the surface too.
        const std::size_t i = k * 2531 % kPoints;
        const double share = (static_cast<double>(i) + 0.5) / kPoints;
        const auto t = static_cast<std::uint32_t>(
            std::min<std::ptrdiff_t>(std::lower_bound(area_to.begin(), area_to.end(), share * area) - area_to.begin(),
                                     static_cast<std::ptrdiff_t>(area_to.size()) - 1));
        // Evenly over the triangle (Roberts' sequence of two numbers, folded at the diagonal of their square).
        const double n = static_cast<double>(i + 1);
        double u = n * 0.7548776662466927 - std::floor(n * 0.7548776662466927);
        double v = n * 0.5698402909980532 - std::floor(n * 0.5698402909980532);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const Vec3d a = surface.corner(t, 0), e1 = surface.corner(t, 1) - a, e2 = surface.corner(t, 2) - a;
        const Vec3d normal = cross(e1, e2);
        const double norm = length(normal);
        if (!(norm > 0)) continue;
        points[i] = a + e1 * u + e2 * v;
        const double d = depth(surface, tree, t, points[i], normal * (-1 / norm), crossings, visits);
        if (d > 0) depths.push_back({d, i});
    }
    if (depths.empty()) return {};
    std::sort(depths.begin(), depths.end());
    const auto& thin = depths[depths.size() / 100];
    return {thin.first, depths[depths.size() / 2].first, points[thin.second]};
}

}  // namespace frm::bake
