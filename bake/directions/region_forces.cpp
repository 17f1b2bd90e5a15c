#include "bake/directions/region_forces.h"

namespace frm::bake {

RegionForces::RegionForces(Transfers& transfers, const Symmetry& symmetry, std::vector<FlowMeans> means,
                           const std::vector<SolvedDirection>& solved, double size, double spacing)
    : transfers_(transfers),
      shape_(transfers.carrier().surface, transfers.carrier().regions, symmetry.centre),
      means_(std::move(means)),
      known_(symmetry, solved, size, spacing, &shape_) {
    for (std::size_t k = 0; k < means_.size(); ++k) {
        for (const Image& image : known_.images_of(k)) {
            site_rest_.push_back(transfers_.mean(means_[k].patch, image.by));
            add_shape(site_rest_.back(), image.direction, -1);
        }
    }
}

void RegionForces::add_shape(std::vector<PatchForce>& force, const Vec3d& e, double factor) const {
    const std::vector<double>& pressures = known_.shape_factors();
    if (pressures.empty()) return;
    const std::vector<ShapePressure::Term> terms = shape_.on_regions(e);
    for (std::size_t l = 0; l < force.size(); ++l)
        for (std::size_t k = 0; k < pressures.size(); ++k) force[l].pressure += terms[l][k] * (factor * pressures[k]);
}

std::vector<PatchForce> RegionForces::mean(const Vec3d& e) const {
    const std::vector<double> weights = known_.fit().weights(e);
    std::vector<PatchForce> out(site_rest_.front().size());
    for (std::size_t site = 0; site < weights.size(); ++site) {
        for (std::size_t l = 0; l < out.size(); ++l) {
            out[l].pressure += site_rest_[site][l].pressure * weights[site];
            out[l].friction += site_rest_[site][l].friction * weights[site];
        }
    }
    add_shape(out, e, 1);
    return out;
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
