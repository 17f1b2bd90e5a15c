#include "bake/mesh/adjacency.h"

#include <algorithm>
#include <limits>
#include <string>
#include <tuple>

#include "bake/error.h"

namespace frm::bake {

std::vector<HalfEdge> sorted_half_edges(const std::vector<Triangle>& triangles) {
    std::vector<HalfEdge> result;
    result.reserve(3 * triangles.size());
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            const auto [low, high] = std::minmax({triangles[t][i], triangles[t][(i + 1) % 3]});
            result.push_back({low, high, t, i});
        }
    }
    std::sort(result.begin(), result.end(), [](const HalfEdge& a, const HalfEdge& b) {
        return std::tie(a.low, a.high, a.triangle, a.side) < std::tie(b.low, b.high, b.triangle, b.side);
    });
    return result;
}

std::size_t edge_end(const std::vector<HalfEdge>& half_edges, std::size_t first) {
    std::size_t end = first;
    while (end < half_edges.size() && half_edges[end].low == half_edges[first].low &&
           half_edges[end].high == half_edges[first].high) {
        ++end;
    }
    return end;
}

Neighbours find_neighbours(const Surface& surface, const char* caller) {
    const std::vector<HalfEdge> half_edges = sorted_half_edges(surface.triangles);
    Neighbours result(surface.triangles.size());
    for (std::size_t i = 0; i < half_edges.size(); i += 2) {
        const HalfEdge& a = half_edges[i];
        if (edge_end(half_edges, i) != i + 2) {
            throw BakeError(std::string(caller) + ": the surface is not closed at the edge between vertices " +
                            std::to_string(a.low) + " and " + std::to_string(a.high) + "; repair() it first");
        }
        const HalfEdge& b = half_edges[i + 1];
        result[a.triangle][a.side] = b.triangle;
        result[b.triangle][b.side] = a.triangle;
    }
    return result;
}

std::uint32_t find_shells(const Neighbours& neighbours, std::vector<std::uint32_t>& shell) {
    constexpr auto none = std::numeric_limits<std::uint32_t>::max();
    shell.assign(neighbours.size(), none);
    std::uint32_t count = 0;
    std::vector<std::uint32_t> queue;
    for (std::uint32_t first = 0; first < neighbours.size(); ++first) {
        if (shell[first] != none) continue;
        shell[first] = count;
        queue.assign(1, first);
        while (!queue.empty()) {
            const std::uint32_t t = queue.back();
            queue.pop_back();
            for (const std::uint32_t n : neighbours[t]) {
                if (shell[n] != none) continue;
                shell[n] = count;
                queue.push_back(n);
            }
        }
        ++count;
    }
    return count;
}

}  // namespace frm::bake
