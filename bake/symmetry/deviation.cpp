#include "bake/symmetry/deviation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace frm::bake {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Visits 0 .. count - 1 in steps of about the golden section: any first part of it is spread over the whole.
std::vector<std::size_t> spread_order(std::size_t count) {
    auto step = static_cast<std::size_t>(0.6180339887498949 * static_cast<double>(count));
    step = std::max<std::size_t>(step, 1);
    while (std::gcd(step, count) != 1) ++step;
    std::vector<std::size_t> order(count);
    for (std::size_t i = 0, at = 0; i < count; ++i, at = (at + step) % count) order[i] = at;
    return order;
}

}  // namespace

Deviation::Deviation(const Surface& surface, const Vec3d& centre, std::size_t most_points)
    : centre_(centre), tree_(surface.vertices, surface.triangles) {
    const std::size_t half = std::max<std::size_t>(most_points / 2, 1);
    std::vector<Point> points;

    // Walked in the tree's order, so that points that follow each other are near each other.
    std::vector<char> seen(surface.vertices.size(), 0);
    std::vector<std::uint32_t> vertices;
    std::vector<double> sum(1, 0.0);
    for (const std::uint32_t t : tree_.order()) {
        for (const std::uint32_t v : surface.triangles[t]) {
            if (!seen[v]) vertices.push_back(v);
            seen[v] = 1;
        }
        const Vec3d a = surface.corner(t, 0);
        sum.push_back(sum.back() + 0.5 * length(cross(surface.corner(t, 1) - a, surface.corner(t, 2) - a)));
    }
    const std::size_t corners = std::min(vertices.size(), half);
    for (std::size_t i = 0; i < corners; ++i)
        points.push_back({surface.vertices[vertices[i * vertices.size() / corners]] - centre, true});

    for (std::size_t i = 0, at = 0; i < half && sum.back() > 0; ++i) {
        const double area = (static_cast<double>(i) + 0.5) / static_cast<double>(half) * sum.back();
        while (at + 2 < sum.size() && sum[at + 1] < area) ++at;
        // Additive recurrence over the triangle (Roberts' R2 sequence, folded).
        double u = 0.7548776662466927 * static_cast<double>(i), v = 0.5698402909980532 * static_cast<double>(i);
        u -= std::floor(u);
        v -= std::floor(v);
        if (u + v > 1) u = 1 - u, v = 1 - v;
        const std::uint32_t t = tree_.order()[at];
        const Vec3d a = surface.corner(t, 0);
        points.push_back({a + (surface.corner(t, 1) - a) * u + (surface.corner(t, 2) - a) * v - centre, false});
    }
    for (const std::size_t i : spread_order(points.size())) points_.push_back(points[i]);
}

double Deviation::worst(const Matrix3& g, double most, std::size_t points) const {
    const double limit = most * most;
    const double beyond = limit * (1 + 1e-9) + std::numeric_limits<double>::min();
    double result = 0;
    for (std::size_t i = 0; i < std::min(points, points_.size()); ++i) {
        result = std::max(result, squared(g, points_[i], beyond));
        if (result > limit) return kInfinite;
    }
    return std::sqrt(result);
}

double Deviation::mean(const Matrix3& g, double most, std::size_t points) const {
    const std::size_t count = std::min(points, points_.size());
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i) sum += squared(g, points_[i], most * most);
    return std::sqrt(sum / static_cast<double>(count));
}

Deviation::Family Deviation::family(const std::vector<Matrix3>& rotations, const Family& most, std::size_t points,
                                    double outer) const {
    const double limit = most.worst * most.worst, beyond = limit * (1 + 1e-9) + std::numeric_limits<double>::min();
    const std::size_t enough = rotations.size() / 12;
    std::vector<double> distances(rotations.size());
    Family result;
    for (std::size_t i = 0; i < std::min(points, points_.size()); ++i) {
        for (std::size_t r = 0; r < rotations.size(); ++r) {
            distances[r] = squared(rotations[r], points_[i], beyond);
            if (distances[r] > limit) return {kInfinite, kInfinite};
            result.worst = std::max(result.worst, distances[r]);
        }
        if (!points_[i].vertex) continue;
        const double inward = outer - length(points_[i].at);
        std::nth_element(distances.begin(), distances.begin() + static_cast<std::ptrdiff_t>(enough), distances.end());
        result.vertices = std::max(result.vertices, std::min(inward * inward, distances[enough]));
        if (result.vertices > most.vertices * most.vertices) return {kInfinite, kInfinite};
    }
    return {std::sqrt(result.worst), std::sqrt(result.vertices)};
}

}  // namespace frm::bake
