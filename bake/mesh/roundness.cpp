#include "bake/mesh/roundness.h"

#include <algorithm>
#include <cmath>

#include "bake/mesh/adjacency.h"

namespace frm::bake {
namespace {

constexpr double sharp = 30 * 3.14159265358979323846 / 180;

Vec3d normal(const Surface& s, std::uint32_t triangle) {
    const Vec3d n = cross(s.corner(triangle, 1) - s.corner(triangle, 0), s.corner(triangle, 2) - s.corner(triangle, 0));
    const double size = length(n);
    return size > 0 ? n / size : Vec3d{};
}

}  // namespace

double roundness(const Surface& surface) {
    const std::vector<HalfEdge> edges = sorted_half_edges(surface.triangles);
    double all = 0, round = 0;
    for (std::size_t first = 0; first < edges.size(); first = edge_end(edges, first)) {
        if (edge_end(edges, first) != first + 2) continue;
        const Vec3d a = normal(surface, edges[first].triangle), b = normal(surface, edges[first + 1].triangle);
        const double angle = std::atan2(length(cross(a, b)), dot(a, b));
        const double turning = length(surface.vertices[edges[first].high] - surface.vertices[edges[first].low]) * angle;
        all += turning;
        if (angle < sharp) round += turning;
    }
    return all > 0 ? round / all : 0;
}

}  // namespace frm::bake
