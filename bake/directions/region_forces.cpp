#include "bake/directions/region_forces.h"

#include <algorithm>

namespace frm::bake {

RegionForces::RegionForces(Transfers& transfers, const Symmetry& symmetry, std::vector<FlowMeans> means,
                           const std::vector<SolvedDirection>& solved, double size, double spacing)
    : transfers_(transfers),
      means_(std::move(means)),
      known_(symmetry, solved, size, spacing),
      // Of a record a few sheddings long the strength is known to some tenths: too little to choose a fit by.
      rms_fit_(known_.sites(), {1, 1e-2}) {
    for (std::size_t k = 0; k < means_.size(); ++k)
        for (const Image& image : known_.images_of(k))
            site_means_.push_back(transfers_.mean(means_[k].patch, image.by));
}

std::vector<PatchForce> RegionForces::mean(const Vec3d& e) const {
    const std::vector<double> weights = known_.fit().weights(e);
    std::vector<PatchForce> out(site_means_.front().size());
    for (std::size_t site = 0; site < weights.size(); ++site) {
        for (std::size_t l = 0; l < out.size(); ++l) {
            out[l].pressure += site_means_[site][l].pressure * weights[site];
            out[l].friction += site_means_[site][l].friction * weights[site];
        }
    }
    return out;
}

double RegionForces::rms(const Vec3d& e) const {
    const std::vector<double> weights = rms_fit_.weights(e);
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * means_[known_.sites()[i].group].rms;
    return std::max(0.0, sum);
}

RegionForces::Nearest RegionForces::nearest(const Vec3d& e) const {
    constexpr double same_direction = 1e-6;  // chord
    constexpr double nearer = 1e-9;          // by more than rounding: of images equally near, the first
    double best = -2;
    Nearest out;
    for (std::size_t k = 0; k < means_.size(); ++k) {
        for (const Image& image : known_.images_of(k)) {
            if (!(dot(image.direction, e) > best + nearer)) continue;
            best = dot(image.direction, e);
            out.flow = k;
            out.solved = length(image.direction - e) < same_direction;
            out.transfer = &transfers_.of(image.by.front());
        }
    }
    return out;
}

}  // namespace frm::bake
