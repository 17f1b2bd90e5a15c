// Fewer triangles of nearly the same shape: what a dense solver can take of a mesh made for the eye.
#pragma once

#include <cstddef>

#include "bake/mesh/surface.h"

namespace frm::bake {

struct Coarse {
    Surface surface;
    bool changed = false;  ///< the shape is no longer quite the same
};

/// Removes edges, those first that bend the surface least (Garland & Heckbert 1997), until at most `most_triangles` are
/// left or none can go; then sides of triangles too thin to have a normal are turned. The volume stays as it is
/// (Lindstrom & Turk 1998), and so does the number of shells and holes. Every edge of `surface` must have exactly two
/// triangles.
Coarse coarsen(const Surface& surface, std::size_t most_triangles);

}  // namespace frm::bake
