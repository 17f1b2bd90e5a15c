// Where on the surface the image of a part of it lies.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/mesh/surface.h"
#include "bake/mesh/tree.h"

namespace frm::bake {

/// A place on the surface and how it faces.
struct Facing {
    Vec3d centre, normal;
};

/// Keeps a reference: the surface must outlive it.
class Landing {
public:
    /// `tolerance` (m) is how far an image may be from the surface; of two sides of a thin blade that are both that near
    /// it is the one that faces the same way.
    Landing(const Surface& surface, double tolerance);

    const Facing& facing_of(std::size_t triangle) const { return facing_[triangle]; }
    /// The triangle that the image is on.
    std::uint32_t find(const Facing& image) const;

private:
    const Surface& surface_;
    Tree tree_;
    double tolerance_;
    std::vector<Facing> facing_;
};

}  // namespace frm::bake
