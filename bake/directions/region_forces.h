// From solved directions to the forces on the haptic regions in any direction: means by a fit over directions,
// fluctuations from the nearest flow.
#pragma once

#include <memory>
#include <vector>

#include "bake/directions/known.h"
#include "bake/directions/transfer.h"
#include "bake/tasks/forces.h"

namespace frm::bake {

class RegionForces {
public:
    /// `means[k]` and `directions[k]`: of one solved flow; all at one speed. `size`, `spacing`: see KnownForces.
    RegionForces(const Carrier& carrier, const Symmetry& symmetry, std::vector<FlowMeans> means,
                 const std::vector<Vec3d>& directions, double size, double spacing);

    /// The mean force on each region in a stream of unit direction e.
    std::vector<PatchForce> mean(const Vec3d& e) const;
    /// How strongly the whole force swings there (rms), N.
    double rms(const Vec3d& e) const;

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
    const Transfer& transfer(const Matrix3& g);

    Carrier carrier_;
    std::vector<FlowMeans> means_;
    KnownForces known_;
    std::vector<std::unique_ptr<Transfer>> transfers_;
    std::vector<std::vector<PatchForce>> site_means_;  // [site][region]
    std::unique_ptr<DirectionFit> rms_fit_;
};

}  // namespace frm::bake
