// How the forces on patches become those on regions where a flow is carried over by an isometry of the body.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/mesh/surface.h"
#include "bake/symmetry/symmetry.h"

namespace frm::bake {

/// The image of a patch covers parts of regions; each gets its share of the patch's force, by area.
class Transfer {
public:
    struct Share {
        std::uint32_t patch, region;
        double share;  ///< those of a patch add up to 1: no force is lost
    };

    /// For the isometry x -> centre + g (x - centre).
    Transfer(const Surface& surface, const Regions& patches, const Regions& regions, const Vec3d& centre,
             const Matrix3& g);

    const std::vector<Share>& shares() const { return shares_; }
    const Matrix3& g() const { return g_; }

private:
    Matrix3 g_;
    std::vector<Share> shares_;
};

}  // namespace frm::bake
