// Which triangle lies across each edge. Sorted arrays throughout: the same surface always gives the same order.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bake/mesh/surface.h"

namespace frm::bake {

/// One side of a triangle: from its corner `side` to the next.
struct HalfEdge {
    std::uint32_t low = 0, high = 0;  ///< the edge's vertices, low < high
    std::uint32_t triangle = 0;
    std::uint32_t side = 0;
};

/// All sides of all triangles, those of one edge together, in the order (low, high, triangle, side).
std::vector<HalfEdge> sorted_half_edges(const std::vector<Triangle>& triangles);

/// One past the last side of the edge whose first side is half_edges[first].
std::size_t edge_end(const std::vector<HalfEdge>& half_edges, std::size_t first);

/// neighbours[t][i] is the triangle across side i of triangle t.
using Neighbours = std::vector<std::array<std::uint32_t, 3>>;

/// Throws BakeError (starting with `caller`) where an edge does not have exactly two triangles; after repair() all do.
Neighbours find_neighbours(const Surface& surface, const char* caller);

/// The connected pieces, numbered by their first triangles; shell[t] is that of triangle t. Returns how many.
std::uint32_t find_shells(const Neighbours& neighbours, std::vector<std::uint32_t>& shell);

}  // namespace frm::bake
