#include "bake/directions/fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bake/math/cholesky.h"

namespace frm::bake {
namespace {

// A force is a constant and a linear part in the direction (a body without preferred directions is dragged along e), and
// what a Matern kernel of smoothness 3/2 leaves: once differentiable, since a flow that begins to separate bends its
// force. The first two may be of any size.
constexpr double trend = 10;

constexpr std::size_t most_sites = 400;  // or so, to choose a model by

double covariance(const Vec3d& a, const Vec3d& b, double range) {
    const double along = dot(a, b), r = std::sqrt(3.0) * length(a - b) / range;
    return trend * (1 + along) + (1 + r) * std::exp(-r);
}

}  // namespace

DirectionFit::DirectionFit(std::vector<FitSite> sites, const FitModel& model)
    : sites_(std::move(sites)), model_(model) {
    const std::size_t n = sites_.size();
    std::vector<double> lower;
    lower.reserve(n * (n + 1) / 2);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j)
            lower.push_back(covariance(sites_[i].direction, sites_[j].direction, model.range));
        lower.back() += model.noise;
        groups_ = std::max(groups_, sites_[i].group + 1);
    }
    const Cholesky factor(std::move(lower), n);
    inverse_.assign(n * n, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        inverse_[i * n + i] = 1;
        factor.solve(inverse_.data() + i * n);
    }
}

std::vector<double> DirectionFit::covariances(const Vec3d& e) const {
    std::vector<double> k;
    for (const FitSite& site : sites_) k.push_back(covariance(e, site.direction, model_.range));
    return k;
}

std::vector<double> DirectionFit::weights(const Vec3d& e) const {
    const std::vector<double> k = covariances(e);
    std::vector<double> w(k.size(), 0.0);
    for (std::size_t i = 0; i < k.size(); ++i)
        for (std::size_t j = 0; j < k.size(); ++j) w[i] += inverse_[i * k.size() + j] * k[j];
    return w;
}

double DirectionFit::doubt(const Vec3d& e) const {
    const std::vector<double> k = covariances(e), w = weights(e);
    double known = 0;
    for (std::size_t i = 0; i < k.size(); ++i) known += k[i] * w[i];
    return std::sqrt(std::max(0.0, covariance(e, e, model_.range) - known));
}

// With P the inverse of the sites' covariance, the error at the sites B of a group that is left out is the solution x of
// P_BB x = (P v)_B (Rasmussen & Williams, eq. 5.12, for a block).
std::vector<FitValue> DirectionFit::left_out(const std::vector<FitValue>& values) const {
    const std::size_t n = sites_.size();
    std::vector<FitValue> out(values);
    for (std::uint32_t group = 0; group < groups_; ++group) {
        std::vector<std::size_t> members;
        for (std::size_t i = 0; i < n; ++i)
            if (sites_[i].group == group) members.push_back(i);
        std::vector<double> block;
        for (std::size_t a = 0; a < members.size(); ++a)
            for (std::size_t b = 0; b <= a; ++b) block.push_back(inverse_[members[a] * n + members[b]]);
        const Cholesky factor(std::move(block), members.size());
        for (std::size_t c = 0; c < FitValue{}.size(); ++c) {
            std::vector<double> error;
            for (const std::size_t i : members) {
                double sum = 0;
                for (std::size_t j = 0; j < n; ++j) sum += inverse_[i * n + j] * values[j][c];
                error.push_back(sum);
            }
            factor.solve(error.data());
            for (std::size_t a = 0; a < members.size(); ++a) out[members[a]][c] -= error[a];
        }
    }
    return out;
}

FitModel choose_model(const std::vector<FitSite>& all_sites, const std::vector<FitValue>& all_values) {
    // The time goes with the cube of the sites. Among so many, some of the groups tell as much as all.
    const auto stride = static_cast<std::uint32_t>((all_sites.size() + most_sites - 1) / most_sites);
    std::vector<FitSite> sites;
    std::vector<FitValue> values;
    for (std::size_t i = 0; i < all_sites.size(); ++i) {
        if (all_sites[i].group % stride != 0) continue;
        sites.push_back({all_sites[i].direction, all_sites[i].group / stride});
        values.push_back(all_values[i]);
    }
    FitModel best;
    double least = -1;
    for (const double range : {0.5, 1.0, 2.0, 4.0}) {
        for (const double noise : {1e-4, 1e-3, 1e-2, 1e-1}) {
            const FitModel model{range, noise};
            const std::vector<FitValue> predicted = DirectionFit(sites, model).left_out(values);
            double square = 0;
            for (std::size_t i = 0; i < sites.size(); ++i)
                for (std::size_t c = 0; c < FitValue{}.size(); ++c)
                    square += (predicted[i][c] - values[i][c]) * (predicted[i][c] - values[i][c]);
            // A later model must be better by more than rounding, which may differ between machines.
            if (least >= 0 && !(square < 0.999 * least)) continue;
            least = square;
            best = model;
        }
    }
    return best;
}

}  // namespace frm::bake
