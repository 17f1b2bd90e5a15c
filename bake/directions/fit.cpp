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

// Variance of a term's factor before any value is known, of a term whose mean square over sites is 1: as good as any, and
// of terms that are alike on this body, or like the linear part, still one answer.
constexpr double factor_variance = 1000;

constexpr std::size_t most_sites = 400;  // or so, to choose a model by

double product(const FitValue& a, const FitValue& b) {
    double sum = 0;
    for (std::size_t c = 0; c < a.size(); ++c) sum += a[c] * b[c];
    return sum;
}

double product(const std::vector<FitValue>& a, const std::vector<FitValue>& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += product(a[i], b[i]);
    return sum;
}

void add(FitValue& to, const FitValue& value, double factor) {
    for (std::size_t c = 0; c < to.size(); ++c) to[c] += factor * value[c];
}

double covariance(const Vec3d& a, const Vec3d& b, double range) {
    const double along = dot(a, b), r = std::sqrt(3.0) * length(a - b) / range;
    return trend * (1 + along) + (1 + r) * std::exp(-r);
}

}  // namespace

DirectionFit::DirectionFit(std::vector<FitSite> sites, const FitModel& model, const FitTerms& terms)
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
    if (model.terms && !terms.empty()) add_terms(terms);
}

// Generalised least squares (Rasmussen & Williams, 2.7): with K the covariance of the sites and X the terms, the factors
// are (X^T K^-1 X + 1/b)^-1 X^T K^-1 v, b the variance that they have before.
void DirectionFit::add_terms(const FitTerms& terms) {
    const std::size_t n = sites_.size(), count = terms.front().size();
    x_.assign(count, std::vector<FitValue>(n));
    px_.assign(count, std::vector<FitValue>(n));
    for (std::size_t k = 0; k < count; ++k) {
        for (std::size_t i = 0; i < n; ++i) x_[k][i] = terms[i][k];
        const double square = product(x_[k], x_[k]) / static_cast<double>(n);
        scale_.push_back(square > 0 ? std::sqrt(square) : 1);
        for (FitValue& value : x_[k])
            for (double& c : value) c /= scale_[k];
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = 0; j < n; ++j) add(px_[k][i], x_[k][j], inverse_[i * n + j]);
        for (std::size_t l = 0; l <= k; ++l) normal_.push_back(product(x_[l], px_[k]));
        normal_.back() += 1 / factor_variance;
    }
}

std::vector<double> DirectionFit::scaled_factors(const std::vector<FitValue>& values) const {
    std::vector<double> factors;
    for (const std::vector<FitValue>& term : px_) factors.push_back(product(term, values));
    if (!factors.empty()) Cholesky(normal_, factors.size()).solve(factors.data());
    return factors;
}

std::vector<double> DirectionFit::factors(const std::vector<FitValue>& values) const {
    std::vector<double> factors = scaled_factors(values);
    for (std::size_t k = 0; k < factors.size(); ++k) factors[k] /= scale_[k];
    return factors;
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

// With Q = P - P X N^-1 X^T P, P the inverse of the sites' covariance and N the terms' normal equations, the error at the
// sites B of a group that is left out is the solution x of Q_BB x = (Q v)_B (Rasmussen & Williams, eq. 5.12, for a block).
// Q_BB differs from P_BB, which is the same for all components, by as many products as there are terms.
std::vector<FitValue> DirectionFit::left_out(const std::vector<FitValue>& values) const {
    const std::size_t n = sites_.size(), terms = x_.size();
    const std::vector<double> known = scaled_factors(values);
    std::vector<FitValue> rest(values);
    for (std::size_t k = 0; k < terms; ++k)
        for (std::size_t i = 0; i < n; ++i) add(rest[i], x_[k][i], -known[k]);

    std::vector<FitValue> out(values);
    for (std::uint32_t group = 0; group < groups_; ++group) {
        std::vector<std::size_t> members;
        for (std::size_t i = 0; i < n; ++i)
            if (sites_[i].group == group) members.push_back(i);
        std::vector<double> block;
        for (std::size_t a = 0; a < members.size(); ++a)
            for (std::size_t b = 0; b <= a; ++b) block.push_back(inverse_[members[a] * n + members[b]]);
        const Cholesky factor(std::move(block), members.size());
        const auto solve = [&](std::vector<FitValue>& right) {
            std::vector<double> column(members.size());
            for (std::size_t c = 0; c < FitValue{}.size(); ++c) {
                for (std::size_t a = 0; a < members.size(); ++a) column[a] = right[a][c];
                factor.solve(column.data());
                for (std::size_t a = 0; a < members.size(); ++a) right[a][c] = column[a];
            }
        };
        std::vector<FitValue> error(members.size());
        for (std::size_t a = 0; a < members.size(); ++a)
            for (std::size_t j = 0; j < n; ++j) add(error[a], rest[j], inverse_[members[a] * n + j]);
        solve(error);
        if (terms > 0) {
            std::vector<std::vector<FitValue>> u(terms), v;
            for (std::size_t k = 0; k < terms; ++k)
                for (const std::size_t i : members) u[k].push_back(px_[k][i]);
            v = u;
            for (std::vector<FitValue>& column : v) solve(column);
            std::vector<double> left, right;
            for (std::size_t k = 0; k < terms; ++k) {
                for (std::size_t l = 0; l <= k; ++l) left.push_back(normal_[k * (k + 1) / 2 + l] - product(u[k], v[l]));
                right.push_back(product(u[k], error));
            }
            Cholesky(std::move(left), terms).solve(right.data());
            for (std::size_t k = 0; k < terms; ++k)
                for (std::size_t a = 0; a < members.size(); ++a) add(error[a], v[k][a], right[k]);
        }
        for (std::size_t a = 0; a < members.size(); ++a) add(out[members[a]], error[a], -1);
    }
    return out;
}

FitModel choose_model(const std::vector<FitSite>& all_sites, const std::vector<FitValue>& all_values,
                      const FitTerms& all_terms) {
    // The time goes with the cube of the sites. Among so many, some of the groups tell as much as all.
    const auto stride = static_cast<std::uint32_t>((all_sites.size() + most_sites - 1) / most_sites);
    std::vector<FitSite> sites;
    std::vector<FitValue> values;
    FitTerms terms;
    for (std::size_t i = 0; i < all_sites.size(); ++i) {
        if (all_sites[i].group % stride != 0) continue;
        sites.push_back({all_sites[i].direction, all_sites[i].group / stride});
        values.push_back(all_values[i]);
        if (!all_terms.empty()) terms.push_back(all_terms[i]);
    }
    FitModel best;
    double least = -1;
    // Of models that are as good, that without terms.
    for (const bool with_terms : {false, true}) {
        if (with_terms && terms.empty()) continue;
        for (const double range : {0.5, 1.0, 2.0, 4.0}) {
            for (const double noise : {1e-4, 1e-3, 1e-2, 3e-2, 1e-1, 3e-1}) {
                const FitModel model{range, noise, with_terms};
                const std::vector<FitValue> predicted = DirectionFit(sites, model, terms).left_out(values);
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
    }
    return best;
}

}  // namespace frm::bake
