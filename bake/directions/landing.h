// Where on the surface the image of a part of it lies.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/mesh/tree.h"
#include "bake/regions/patches.h"

namespace frm::bake {

/// Keeps a reference: the surface must outlive it.
class Landing {
public:
    /// `tolerance` (m; at least a millionth of the surface's size) is how far an image may be from the surface; of two
    /// sides of a thin blade that are both that near it is the one that faces the same way.
    Landing(const Surface& surface, double tolerance);

    const Facet& facet(std::size_t triangle) const { return facets_[triangle]; }
    /// The triangle that the image of a facet is on.
    std::uint32_t find(const Vec3d& centre, const Vec3d& normal) const;

private:
    const Surface& surface_;
    Tree tree_;
    double tolerance_;
    std::vector<Facet> facets_;
};

}  // namespace frm::bake
