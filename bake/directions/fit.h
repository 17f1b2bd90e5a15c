// From forces at a few directions of the stream to the force at any: a smooth fit on the sphere (kriging; Rasmussen &
// Williams 2006, Gaussian Processes for Machine Learning, ch. 2, 4.2 and 5.4.2).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math/vec.h"

namespace frm::bake {

/// A direction where the force is known. Sites of one group are one flow and its images under the body's symmetry: they
/// are known, or left out, together.
struct FitSite {
    Vec3d direction;
    std::uint32_t group = 0;
};

/// How far the force at one direction tells of that at another, and how far it is itself uncertain.
struct FitModel {
    double range = 1;     ///< of the correlation, as a chord of the unit sphere
    double noise = 1e-4;  ///< variance of a site's error, as a share of the variance over directions
    bool terms = false;   ///< whether the fit makes use of its terms
};

/// What is fitted: force and torque, or anything else of six components.
using FitValue = std::array<double, 6>;
/// [site][term]: what is known to be like the values but for a factor of each term, which the values tell. None: empty.
using FitTerms = std::vector<std::vector<FitValue>>;

class DirectionFit {
public:
    /// Groups are numbered from 0 without gaps. Terms that the model makes no use of are left out.
    DirectionFit(std::vector<FitSite> sites, const FitModel& model, const FitTerms& terms = {});

    /// The factors of the terms; empty where there are none.
    std::vector<double> factors(const std::vector<FitValue>& values) const;
    /// The value at unit vector e is that of the terms there, times their factors, and the sum over sites of weight times
    /// what the terms leave of the site's value.
    std::vector<double> weights(const Vec3d& e) const;
    /// Standard deviation of the value at e as a share of that over all directions, before any value is known: 0 near
    /// sites, towards 1 far from all.
    double doubt(const Vec3d& e) const;
    /// What the other groups say of each site's value, were its own group not known: neither to the factors.
    std::vector<FitValue> left_out(const std::vector<FitValue>& values) const;

private:
    std::vector<double> covariances(const Vec3d& e) const;
    void add_terms(const FitTerms& terms);
    std::vector<double> scaled_factors(const std::vector<FitValue>& values) const;

    std::vector<FitSite> sites_;
    FitModel model_;
    std::vector<double> inverse_;  // [site][site]
    // Of the terms, each divided by its scale: themselves, the inverse times them, and the normal equations.
    std::vector<double> scale_;                  // [term]
    std::vector<std::vector<FitValue>> x_, px_;  // [term][site]
    std::vector<double> normal_;                 // lower half
    std::uint32_t groups_ = 0;
};

/// The model that predicts each group best from the others (leave-one-out cross-validation), among a few. Of many
/// groups, some are asked.
FitModel choose_model(const std::vector<FitSite>& sites, const std::vector<FitValue>& values,
                      const FitTerms& terms = {});

}  // namespace frm::bake
