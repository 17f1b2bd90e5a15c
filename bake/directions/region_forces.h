// From solved directions to the forces on the haptic regions in any direction: means by a fit over directions, and the
// nearest flow.
#pragma once

#include <vector>

#include "bake/directions/known.h"
#include "bake/directions/transfer.h"
#include "bake/tasks/forces.h"

namespace frm::bake {

class RegionForces {
public:
    /// `means[k]` and `solved[k]`: of one flow; all at one speed. `size`, `spacing`: see KnownForces. Keeps a reference
    /// to `transfers`.
    RegionForces(Transfers& transfers, const Symmetry& symmetry, std::vector<FlowMeans> means,
                 const std::vector<SolvedDirection>& solved, double size, double spacing);

    /// The mean force on each region in a stream of unit direction e.
    std::vector<PatchForce> mean(const Vec3d& e) const;

    /// The flow whose image is nearest to e, and the isometry that makes that image.
    struct Nearest {
        std::size_t flow = 0;
        const Transfer* transfer = nullptr;
        bool solved = false;  ///< e is that image
    };
    Nearest nearest(const Vec3d& e) const;

    const KnownForces& known() const { return known_; }
    const std::vector<FlowMeans>& flows() const { return means_; }

private:
    void add_shape(std::vector<PatchForce>& force, const Vec3d& e, double factor) const;

    Transfers& transfers_;
    ShapePressure shape_;
    std::vector<FlowMeans> means_;
    KnownForces known_;
    std::vector<std::vector<PatchForce>> site_rest_;  // [site][region]: means less the shape's terms
};

}  // namespace frm::bake
