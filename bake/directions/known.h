// What the solved flows say of the mean force in all directions: where it is known, how well each flow is predicted by
// the others, and where the next one would tell most.
#pragma once

#include <vector>

#include "bake/directions/fit.h"
#include "bake/directions/images.h"
#include "bake/directions/shape_pressure.h"
#include "bake/symmetry/symmetry.h"
#include "bake/tasks/forces.h"

namespace frm::bake {

/// A solved direction's mean force and torque (about the symmetry's centre) on the whole body.
struct SolvedDirection {
    Vec3d direction;
    Vec3d force, torque;
};

SolvedDirection solved_direction(const Vec3d& e, const FlowMeans& means, const Vec3d& centre);

/// Errors of the force at directions that were left out, as shares of the largest force.
struct DirectionErrors {
    double rms = 0, worst = 0;
};

class KnownForces {
public:
    /// `size`: a length that makes a force of a torque. Images are no farther apart than `spacing` radians. `shape` is of
    /// the body, about the symmetry's centre; without it the fit knows nothing of the body but the flows.
    KnownForces(const Symmetry& symmetry, const std::vector<SolvedDirection>& solved, double size, double spacing,
                const ShapePressure* shape = nullptr);

    const std::vector<Image>& images_of(std::size_t k) const { return images_[k]; }
    /// All images of all solved directions, in their order; a site's group is its solved direction.
    const std::vector<FitSite>& sites() const { return sites_; }
    const DirectionFit& fit() const { return fit_; }
    /// The pressure of each of the shape's terms, Pa; empty where the fit is better without.
    const std::vector<double>& shape_factors() const { return factors_; }
    /// Mean torque on the whole body about the symmetry's centre, N m, in a stream of unit direction e.
    Vec3d torque(const Vec3d& e) const;

    /// Every solved direction predicted from the others; zero, which is not known, where there is one only.
    DirectionErrors errors() const;
    /// Solved direction k predicted from the others: the worst of its images, share of the largest force.
    double error_of(std::size_t k) const;
    /// `count` directions to solve next: where the forces around are predicted badly and the nearest is far.
    std::vector<Vec3d> next(std::size_t count) const;

private:
    const Symmetry& symmetry_;
    double size_, spacing_;
    const ShapePressure* shape_;
    std::vector<std::vector<Image>> images_;
    std::vector<FitSite> sites_;
    std::vector<FitValue> values_;
    FitTerms terms_;
    std::vector<double> error_;  // of the force at each site, predicted without its group; share of the largest force
    FitModel model_;
    DirectionFit fit_;
    std::vector<double> factors_;
    std::vector<FitValue> rest_;  // of the values, less the shape's terms
};

/// Mean angle between neighbours of a lattice, radians.
double spacing_of(std::uint32_t frequency);

/// Those of a lattice's directions that are not images of others of them, nearly enough.
std::vector<Vec3d> distinct_directions(const Symmetry& symmetry, std::uint32_t frequency);

}  // namespace frm::bake
