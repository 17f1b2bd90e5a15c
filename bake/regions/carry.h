// The forces on regions in a direction that was not solved but is the image of one that was.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/math/matrix.h"
#include "bake/mesh/surface.h"

namespace frm::bake {

/// Regions are not symmetric where the body is, so the image of a region's force is no region's force. The flow is
/// therefore solved for parts that are so small that each element carries a part into one region.
struct CarriedRegions {
    Regions parts;
    /// region[e][p]: where the element e carries part p. The force on a region l in a stream along elements[e] * c is
    ///   F_l = elements[e] * (sum of the forces in a stream along c on the parts p with region[e][p] = l),
    /// and likewise for each moment of a series. Each part goes somewhere: the force on the whole body is kept.
    std::vector<std::vector<std::uint32_t>> region;
};

/// The fewest parts that are enough for `elements`, about `centre` (see Symmetry); at most one for each triangle, at
/// which the borders of carried regions are: they are as jagged as the triangles are large. `tolerance` (metres) is how
/// far an image may be from the surface; of two sides of a thin blade that are both that near it is the one that faces
/// the same way. Parts are numbered in the order of their first triangles.
CarriedRegions carry_regions(const Surface& surface, const Regions& regions, const std::vector<Matrix3>& elements,
                             const Vec3d& centre, double tolerance);

}  // namespace frm::bake
