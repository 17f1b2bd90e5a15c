#include "bake/directions/known.h"

#include <algorithm>
#include <cmath>

#include "core/map/directions.h"

namespace frm::bake {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::uint32_t candidates = 9;  // frequency of the lattice that the next directions are taken from
constexpr double neighbourhood = 0.5;    // chord within which a bad prediction says that more is needed

std::vector<FitSite> sites_of(const std::vector<std::vector<Image>>& images) {
    std::vector<FitSite> sites;
    for (std::uint32_t k = 0; k < images.size(); ++k)
        for (const Image& image : images[k]) sites.push_back({image.direction, k});
    return sites;
}

std::vector<std::vector<Image>> images_of(const Symmetry& symmetry, const std::vector<SolvedDirection>& solved,
                                          double spacing) {
    std::vector<std::vector<Image>> out;
    for (const SolvedDirection& s : solved) out.push_back(images(symmetry, s.direction, spacing));
    return out;
}

/// Force and torque of the image of a flow; the mean over the isometries that make the same one.
FitValue value_of(const Image& image, const SolvedDirection& solved, double size) {
    Vec3d force, torque;
    for (const Matrix3& g : image.by) {
        force += g * solved.force;
        torque += (g * solved.torque) * determinant(g);  // an axial vector
    }
    const double share = 1.0 / static_cast<double>(image.by.size());
    force *= share;
    torque *= share / size;
    return {force.x, force.y, force.z, torque.x, torque.y, torque.z};
}

FitTerms terms_of(const std::vector<FitSite>& sites, const ShapePressure* shape, double size) {
    FitTerms terms;
    for (const FitSite& site : sites)
        if (shape) terms.push_back(shape->on_body(site.direction, size));
    return terms;
}

Vec3d force_of(const FitValue& value) { return {value[0], value[1], value[2]}; }

std::vector<FitValue> values_of(const std::vector<std::vector<Image>>& images,
                                const std::vector<SolvedDirection>& solved, double size) {
    std::vector<FitValue> values;
    for (std::size_t k = 0; k < solved.size(); ++k)
        for (const Image& image : images[k]) values.push_back(value_of(image, solved[k], size));
    return values;
}

}  // namespace

SolvedDirection solved_direction(const Vec3d& e, const FlowMeans& means, const Vec3d& centre) {
    return {e, means.force, means.torque - cross(centre, means.force)};
}

double spacing_of(std::uint32_t frequency) { return std::sqrt(4 * pi / (4.0 * frequency * frequency + 2)); }

KnownForces::KnownForces(const Symmetry& symmetry, const std::vector<SolvedDirection>& solved, double size,
                         double spacing, const ShapePressure* shape)
    : symmetry_(symmetry),
      size_(size),
      spacing_(spacing),
      shape_(shape),
      images_(bake::images_of(symmetry, solved, spacing)),
      sites_(sites_of(images_)),
      values_(values_of(images_, solved, size)),
      terms_(terms_of(sites_, shape, size)),
      model_(choose_model(sites_, values_, terms_)),
      fit_(sites_, model_, terms_),
      factors_(fit_.factors(values_)),
      rest_(values_) {
    for (std::size_t i = 0; i < rest_.size(); ++i)
        for (std::size_t k = 0; k < factors_.size(); ++k)
            for (std::size_t c = 0; c < rest_[i].size(); ++c) rest_[i][c] -= factors_[k] * terms_[i][k][c];
    const std::vector<FitValue> predicted = fit_.left_out(values_);
    double largest = 0;
    for (const FitValue& value : values_) largest = std::max(largest, length(force_of(value)));
    for (std::size_t i = 0; i < values_.size(); ++i)
        error_.push_back(largest > 0 ? length(force_of(predicted[i]) - force_of(values_[i])) / largest : 0);
}

Vec3d KnownForces::torque(const Vec3d& e) const {
    const std::vector<double> weights = fit_.weights(e);
    Vec3d sum;
    for (std::size_t i = 0; i < weights.size(); ++i)
        sum += Vec3d(rest_[i][3], rest_[i][4], rest_[i][5]) * (weights[i] * size_);
    if (factors_.empty()) return sum;
    const std::vector<FitValue> terms = shape_->on_body(e, size_);
    for (std::size_t k = 0; k < factors_.size(); ++k)
        sum += Vec3d(terms[k][3], terms[k][4], terms[k][5]) * (factors_[k] * size_);
    return sum;
}

DirectionErrors KnownForces::errors() const {
    // A flow counts as the share of the sphere that its images cover: those along an axis have fewer of them.
    DirectionErrors out;
    if (images_.size() < 2) return out;
    for (const double e : error_) {
        out.rms += e * e / static_cast<double>(error_.size());
        out.worst = std::max(out.worst, e);
    }
    out.rms = std::sqrt(out.rms);
    return out;
}

double KnownForces::error_of(std::size_t k) const {
    double worst = 0;
    for (std::size_t i = 0; i < sites_.size(); ++i)
        if (sites_[i].group == k) worst = std::max(worst, error_[i]);
    return worst;
}

std::vector<Vec3d> KnownForces::next(std::size_t count) const {
    const DirectionSet lattice(candidates);
    const double least_apart = 0.5 * spacing_of(candidates);
    std::vector<FitSite> sites = sites_;
    std::vector<Vec3d> chosen;
    while (chosen.size() < count) {
        const DirectionFit fit(sites, model_);
        double best = 0;
        Vec3d where;
        for (std::uint32_t d = 0; d < lattice.count(); ++d) {
            const Vec3d e = lattice.direction(d);
            double sum = 0, weight = 0, nearest = 2;
            for (std::size_t i = 0; i < sites.size(); ++i) {
                const double r = length(e - sites[i].direction);
                nearest = std::min(nearest, r);
                if (i >= error_.size()) continue;
                const double w = std::exp(-(r / neighbourhood) * (r / neighbourhood));
                sum += w * error_[i] * error_[i];
                weight += w;
            }
            if (nearest < least_apart || !(weight > 0)) continue;
            const double score = std::sqrt(sum / weight) * fit.doubt(e);
            // Images of one direction score alike but for rounding, which may differ between machines: the first of them.
            if (score > 1.0001 * best) {
                best = score;
                where = e;
            }
        }
        if (!(best > 0)) break;
        chosen.push_back(where);
        const std::uint32_t group = sites.back().group + 1;
        for (const Image& image : images(symmetry_, where, spacing_)) sites.push_back({image.direction, group});
    }
    return chosen;
}

std::vector<Vec3d> distinct_directions(const Symmetry& symmetry, std::uint32_t frequency) {
    const DirectionSet lattice(frequency);
    const double least_apart = 0.5 * spacing_of(frequency);
    std::vector<Vec3d> kept;
    for (std::uint32_t d = 0; d < lattice.count(); ++d) {
        const Vec3d e = lattice.direction(d);
        if (std::all_of(kept.begin(), kept.end(),
                        [&](const Vec3d& other) { return apart(symmetry, e, other) > least_apart; }))
            kept.push_back(e);
    }
    return kept;
}

}  // namespace frm::bake
