// How the forces on patches become those on regions where a flow is carried over by an isometry of the body. Regions are
// not symmetric where the body is, so the image of a region's force is no region's force; a flow is recorded on patches.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "bake/directions/landing.h"
#include "bake/math/matrix.h"
#include "bake/mesh/surface.h"
#include "bake/tasks/forces.h"

namespace frm::bake {

/// The body that flows are carried over on.
struct Carrier {
    const Surface& surface;
    const Regions &patches, &regions;
    Vec3d centre;  ///< of the isometries
    const Landing& landing;
};

/// Each triangle of a patch gives its part of the patch's force, by area, to the region that its image lies on.
class Transfer {
public:
    struct Share {
        std::uint32_t patch, region;
        double share;  ///< those of a patch add up to 1: no force is lost
    };

    /// For the isometry x -> centre + g (x - centre).
    Transfer(const Carrier& carrier, const Matrix3& g);

    const std::vector<Share>& shares() const { return shares_; }
    const Matrix3& g() const { return g_; }

private:
    Matrix3 g_;
    std::vector<Share> shares_;
};

/// The transfers of one body, each worked out when it is first asked for.
class Transfers {
public:
    explicit Transfers(const Carrier& carrier) : carrier_(carrier) {}

    const Carrier& carrier() const { return carrier_; }
    /// Good as long as this is.
    const Transfer& of(const Matrix3& g);
    /// The mean, over the isometries of `by`, of the forces on regions that a flow's forces on patches become.
    std::vector<PatchForce> mean(const std::vector<PatchForce>& patch, const std::vector<Matrix3>& by);

private:
    Carrier carrier_;
    std::deque<Transfer> known_;
};

/// The fewest patches each of which every element of a finite group carries into one region, so that carried regions
/// are as exact as triangles are small. Numbered in the order of their first triangles.
Regions patches_for(const Surface& surface, const Regions& regions, const std::vector<Matrix3>& elements,
                    const Vec3d& centre, const Landing& landing);

}  // namespace frm::bake
