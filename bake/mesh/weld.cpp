#include "bake/mesh/weld.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace frm::bake {

namespace {

using Cell = std::uint64_t;

// Cells are wider than the tolerance, so that a vertex usually has one cell to look in and never more than eight.
constexpr double kCellWidth = 4;

Cell key(const std::array<std::int64_t, 3>& c) {
    return static_cast<Cell>(c[0]) << 42 | static_cast<Cell>(c[1]) << 21 | static_cast<Cell>(c[2]);
}

}  // namespace

std::vector<std::uint32_t> weld_vertices(const std::vector<Vec3d>& vertices, double tolerance) {
    constexpr auto none = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> first(vertices.size());
    if (vertices.empty()) return first;

    Vec3d low = vertices[0];
    for (const Vec3d& p : vertices) low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    const double width = kCellWidth * tolerance;

    // The map is only looked up, never walked: its order does not reach the result.
    std::unordered_map<Cell, std::uint32_t> newest_in_cell;
    newest_in_cell.reserve(vertices.size());
    std::vector<std::uint32_t> next_in_cell(vertices.size(), none);
    for (std::uint32_t v = 0; v < vertices.size(); ++v) {
        const Vec3d& p = vertices[v];
        std::array<std::int64_t, 3> from{}, to{}, own{};
        for (int i = 0; i < 3; ++i) {
            const auto k = static_cast<std::size_t>(i);
            const double x = p[i] - low[i];
            own[k] = static_cast<std::int64_t>(x / width);
            from[k] = static_cast<std::int64_t>(std::max(x - tolerance, 0.0) / width);
            to[k] = static_cast<std::int64_t>((x + tolerance) / width);
        }
        std::uint32_t found = v;
        for (auto x = from[0]; x <= to[0]; ++x) {
            for (auto y = from[1]; y <= to[1]; ++y) {
                for (auto z = from[2]; z <= to[2]; ++z) {
                    const auto cell = newest_in_cell.find(key({x, y, z}));
                    for (std::uint32_t w = cell == newest_in_cell.end() ? none : cell->second; w != none;
                         w = next_in_cell[w]) {
                        const Vec3d d = vertices[w] - p;
                        if (w < found && dot(d, d) <= tolerance * tolerance) found = w;
                    }
                }
            }
        }
        first[v] = found;
        if (found != v) continue;
        std::uint32_t& newest = newest_in_cell.try_emplace(key(own), none).first->second;
        next_in_cell[v] = newest;
        newest = v;
    }
    return first;
}

}  // namespace frm::bake
