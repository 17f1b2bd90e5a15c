#include "bake/directions/region_forces.h"

#include <algorithm>

namespace frm::bake {
namespace {

std::vector<SolvedDirection> solved_directions(const std::vector<FlowMeans>& means,
                                               const std::vector<Vec3d>& directions, const Vec3d& centre) {
    std::vector<SolvedDirection> out;
    for (std::size_t k = 0; k < means.size(); ++k)
        out.push_back({directions[k], means[k].force, means[k].torque - cross(centre, means[k].force)});
    return out;
}

bool same(const Matrix3& a, const Matrix3& b) { return a.row == b.row; }

}  // namespace

RegionForces::RegionForces(const Carrier& carrier, const Symmetry& symmetry, std::vector<FlowMeans> means,
                           const std::vector<Vec3d>& directions, double size, double spacing)
    : carrier_(carrier),
      means_(std::move(means)),
      known_(symmetry, solved_directions(means_, directions, carrier.centre), size, spacing) {
    std::vector<FitSite> sites;
    for (std::uint32_t k = 0; k < means_.size(); ++k) {
        for (const Image& image : known_.images_of(k)) {
            std::vector<PatchForce> mean(carrier_.regions.count);
            const double part = 1.0 / static_cast<double>(image.by.size());
            for (const Matrix3& g : image.by) {
                for (const Transfer::Share& s : transfer(g).shares()) {
                    const PatchForce& from = means_[k].patch[s.patch];
                    mean[s.region].pressure += (g * from.pressure) * (s.share * part);
                    mean[s.region].friction += (g * from.friction) * (s.share * part);
                }
            }
            site_means_.push_back(std::move(mean));
            sites.push_back({image.direction, k});
        }
    }
    // Of a record a few sheddings long the strength is known to some tenths: no fit of it can be chosen by how well it
    // predicts. Each flow keeps its own.
    rms_fit_ = std::make_unique<DirectionFit>(sites, FitModel{1, 1e-2});
}

const Transfer& RegionForces::transfer(const Matrix3& g) {
    for (const auto& known : transfers_)
        if (same(known->g(), g)) return *known;
    transfers_.push_back(std::make_unique<Transfer>(carrier_, g));
    return *transfers_.back();
}

std::vector<PatchForce> RegionForces::mean(const Vec3d& e) const {
    const std::vector<double> weights = known_.fit().weights(e);
    std::vector<PatchForce> out(carrier_.regions.count);
    for (std::size_t site = 0; site < weights.size(); ++site) {
        for (std::size_t l = 0; l < out.size(); ++l) {
            out[l].pressure += site_means_[site][l].pressure * weights[site];
            out[l].friction += site_means_[site][l].friction * weights[site];
        }
    }
    return out;
}

double RegionForces::rms(const Vec3d& e) const {
    const std::vector<double> weights = rms_fit_->weights(e);
    double sum = 0;
    for (std::size_t k = 0; k < means_.size(); ++k)
        for (std::size_t i = 0; i < known_.images_of(k).size(); ++i)
            sum += weights[known_.first_site(k) + i] * means_[k].rms;
    return std::max(0.0, sum);
}

RegionForces::Nearest RegionForces::nearest(const Vec3d& e) const {
    constexpr double same_direction = 1e-6;  // chord
    constexpr double nearer = 1e-9;  // by more than rounding: of images equally near, the first
    double best = -2;
    Nearest out;
    for (std::size_t k = 0; k < means_.size(); ++k) {
        for (const Image& image : known_.images_of(k)) {
            if (!(dot(image.direction, e) > best + nearer)) continue;
            best = dot(image.direction, e);
            out.flow = k;
            out.solved = length(image.direction - e) < same_direction;
            out.transfer = std::find_if(transfers_.begin(), transfers_.end(), [&](const auto& t) {
                               return same(t->g(), image.by.front());
                           })->get();
        }
    }
    return out;
}

}  // namespace frm::bake
