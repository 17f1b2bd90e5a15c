#include "bake/symmetry/symmetry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "bake/error.h"
#include "bake/symmetry/deviation.h"
#include "bake/symmetry/group.h"
#include "bake/symmetry/moments.h"

namespace frm::bake {
namespace {

constexpr double kPi = 3.14159265358979323846, kInfinite = std::numeric_limits<double>::infinity();
constexpr int kMostTurns = 12;
constexpr double kNearlyEqual = 0.05;  // principal moments, as a share of the largest: their axes may be anywhere
constexpr std::size_t kMostAxes = 64;
constexpr std::size_t kMostPoints = 8000, kFewPoints = 200, kQueries = 200000;
// Rotations that stand for all of a continuous family: so many that some bring a facet's border to each vertex.
constexpr std::size_t kTurns = 24, kAttitudes = 64;

double radius_about(const Surface& surface, const Vec3d& centre, const Vec3d& axis) {
    double largest = 0;
    for (const Vec3d& v : surface.vertices) largest = std::max(largest, length(cross(axis, v - centre)));
    return largest;
}

// By the n-th part of a turn about the axis, then mirrored across it if so told: n = 1 is a mirror then, n = 2 the
// inversion.
struct Candidate {
    Vec3d axis;
    int turns;
    bool mirrored;

    Matrix3 matrix(const Vec3d& about) const {
        const Matrix3 turn = turns == 1 ? Matrix3{} : rotation_about(about, 2 * kPi / turns);
        return mirrored ? mirror_across(about) * turn : turn;
    }
    Matrix3 matrix() const { return matrix(axis); }
};

class Search {
public:
    Search(const Surface& surface, const SymmetryOptions& options)
        : surface_(surface), options_(options), deviation_(surface, measure(surface).centroid, kMostPoints) {
        result_.centre = measure(surface).centroid;
        principal_ = principal_axes(surface, result_.centre);
        result_.size = kInfinite;
        for (const Vec3d& axis : principal_.axis)
            result_.size = std::min(result_.size, radius_about(surface, result_.centre, axis));
        tolerance_ = options.tolerance * result_.size;
        chord_ = std::max(options.chord_tolerance, options.tolerance) * result_.size;
    }

    Symmetry run() {
        axes_.assign(principal_.axis.begin(), principal_.axis.end());
        const bool first = alike(0, 1), second = alike(1, 2);
        if (first || second) {
            for (const Vec3d& axis : stationary_axes(surface_, result_.centre, kMostAxes)) add_axis(axis);
            if (find_family(first, second)) return result_;
        }
        result_.tolerance = tolerance_;
        result_.elements = {Matrix3{}};
        for (std::size_t i = 0; i < axes_.size(); ++i) try_axis(axes_[i]);
        if (first && second) {
            // A body whose moments are equal by chance, such as a prism of a certain height: any of its axes may be the
            // main one.
            const std::vector<Vec3d> known = axes_;
            for (const Vec3d& axis : known)
                if (turns_about(axis) > 2 && keeps(axis)) search_across(axis);
        } else if (first || second) {
            search_across(principal_.axis[first ? 2 : 0]);
        }
        choose_inside();
        return result_;
    }

private:
    bool alike(std::size_t i, std::size_t j) const {
        return std::fabs(principal_.moment[i] - principal_.moment[j]) < kNearlyEqual * principal_.moment[0];
    }

    void add_axis(const Vec3d& axis) {
        for (const Vec3d& known : axes_)
            if (std::fabs(dot(known, axis)) > 1 - 1e-10) return;
        axes_.push_back(axis);
    }

    bool is_family(const std::vector<Matrix3>& rotations, double outer, Deviation::Family& found) const {
        if (!(deviation_.worst(rotations.front(), chord_, kFewPoints) <= chord_)) return false;
        found = deviation_.family(rotations, {chord_, tolerance_}, kQueries / rotations.size(), outer);
        return found.worst <= chord_ && found.vertices <= tolerance_;
    }

    // Angles more than 30 degrees from none: the dent that must be seen is not laid upon itself.
    static std::vector<double> angles(std::size_t count) {
        std::vector<double> result;
        for (int k = 1; result.size() < count; ++k) {
            double turn = 0.3819660112501051 * k;
            turn -= std::floor(turn);
            if (turn > 1.0 / 12 && turn < 11.0 / 12) result.push_back(2 * kPi * turn);
        }
        return result;
    }

    bool find_family(bool first, bool second) {
        Deviation::Family found;
        result_.tolerance = chord_;
        if (first && second) {
            std::vector<Matrix3> rotations;
            // Evenly over all attitudes: Euler angles, the cosine of the middle one even (a Kronecker sequence).
            for (std::size_t k = 1; k <= kAttitudes; ++k) {
                const auto part = [&](double step) {
                    return step * static_cast<double>(k) - std::floor(step * static_cast<double>(k));
                };
                rotations.push_back(rotation_about({0, 0, 1}, 2 * kPi * part(0.8191725133961645)) *
                                    rotation_about({1, 0, 0}, std::acos(1 - 2 * part(0.6710436067037893))) *
                                    rotation_about({0, 0, 1}, 2 * kPi * part(0.5497004779019703)));
            }
            double outer = 0;
            for (const Vec3d& v : surface_.vertices) outer = std::max(outer, length(v - result_.centre));
            if (is_family(rotations, outer, found)) {
                result_.kind = SymmetryKind::spherical;
                result_.worst = found.worst;
                return true;
            }
        }
        for (const Vec3d& axis : axes_) {
            std::vector<Matrix3> rotations;
            for (const double angle : angles(kTurns)) rotations.push_back(rotation_about(axis, angle));
            if (!is_family(rotations, kInfinite, found)) continue;
            result_.axis = upright(axis);
            result_.worst = found.worst;
            for (Matrix3& g : rotations) g = g * mirror_across(axis);
            const bool mirrored = is_family(rotations, kInfinite, found);
            result_.kind = mirrored ? SymmetryKind::axial_mirrored : SymmetryKind::axial;
            if (mirrored) result_.worst = std::max(result_.worst, found.worst);
            return true;
        }
        return false;
    }

    static Vec3d upright(Vec3d axis) {
        int largest = 0;
        for (int i = 1; i < 3; ++i)
            if (std::fabs(axis[i]) > std::fabs(axis[largest]) + 1e-9) largest = i;
        if (axis[largest] < 0) axis = -axis;
        for (int i = 0; i < 3; ++i) {
            Vec3d unit;
            unit[i] = 1;
            if (length(axis - unit) < 1e-9) axis = unit;
        }
        return axis;
    }

    int turns_about(const Vec3d& axis) const {
        int count = 0;
        for (const Matrix3& g : result_.elements) count += determinant(g) > 0 && length(g * axis - axis) < 0.05;
        return count;
    }

    // Whether no element turns the axis to another: those that do are of a cube or the like, and all found by then.
    bool keeps(const Vec3d& axis) const {
        return std::all_of(result_.elements.begin(), result_.elements.end(),
                           [&](const Matrix3& g) { return std::fabs(dot(g * axis, axis)) > 0.99; });
    }

    void try_axis(const Vec3d& axis) {
        for (int turns = kMostTurns; turns >= 1; --turns) {
            if (turns > 1) consider({axis, turns, false});
            consider({axis, turns, true});
        }
    }

    // Mirror planes through the main axis and half turns across it: their angle, by looking all around.
    void search_across(const Vec3d& main) {
        constexpr int steps = 180;
        const Vec3d u = any_across(main), v = cross(main, u);
        const double cap = 0.2 * result_.size;
        for (const bool mirrored : {true, false}) {
            const auto at = [&](double angle) {
                return Candidate{u * std::cos(angle) + v * std::sin(angle), mirrored ? 1 : 2, mirrored};
            };
            std::array<double, steps> score{};
            for (int s = 0; s < steps; ++s)
                score[static_cast<std::size_t>(s)] = deviation_.mean(at(kPi * s / steps).matrix(), cap, kFewPoints / 2);
            for (int s = 0; s < steps; ++s) {
                const double here = score[static_cast<std::size_t>(s)];
                if (here > score[static_cast<std::size_t>((s + 1) % steps)] ||
                    here > score[static_cast<std::size_t>((s + steps - 1) % steps)] || here > 0.03 * result_.size)
                    continue;
                consider(polished(at(kPi * s / steps)));
            }
        }
    }

    // Tilts the axis until the image fits best (pattern search, from 2 degrees down to a thousandth).
    Candidate polished(Candidate c) const {
        const double cap = 0.2 * result_.size;
        const auto score = [&](const Vec3d& axis) { return deviation_.mean(c.matrix(axis), cap, kFewPoints); };
        double best = score(c.axis);
        const double least = 1e-9 * result_.size;
        for (double step = 0.035; step > 1.5e-5 && best > least; step *= 0.5) {
            for (int moves = 0; moves < 4; ++moves) {
                const Vec3d u = any_across(c.axis), v = cross(c.axis, u);
                Vec3d better = c.axis;
                for (const Vec3d& way : {u, -u, v, -v}) {
                    Vec3d axis = c.axis + way * step;
                    axis = axis / length(axis);
                    const double s = score(axis);
                    if (s < best - 1e-12 * result_.size) {
                        best = s;
                        better = axis;
                    }
                }
                if (better == c.axis) break;
                c.axis = better;
            }
        }
        return c;
    }

    void consider(Candidate c) {
        if (find_element(result_.elements, c.matrix()) < result_.elements.size()) return;
        // Axes of moments are a little off where the body is only nearly symmetric.
        const double quick = deviation_.worst(c.matrix(), 4 * tolerance_, kFewPoints);
        if (!(quick <= 4 * tolerance_)) return;
        if (quick > 0.2 * tolerance_ && polishes_left_ > 0) {
            --polishes_left_;
            c = polished(c);
        }
        if (!(deviation_.worst(c.matrix(), 1.5 * tolerance_, kFewPoints) <= 1.5 * tolerance_)) return;
        std::vector<Matrix3> generators = result_.elements;
        generators.push_back(c.matrix());
        const std::vector<Matrix3> group = span_group(generators);
        if (group.empty()) return;
        // Each distance is measured both ways: with an element its inverse is in the group.
        const std::size_t points = std::max<std::size_t>(1500, kQueries / group.size());
        double worst = 0;
        for (const Matrix3& g : group) {
            worst = std::max(worst, deviation_.worst(g, tolerance_, points));
            if (!(worst <= tolerance_)) return;
        }
        result_.elements = group;
        result_.worst = worst;
    }

    // Of some directions without any meaning the one that is farthest from its images, so that the domain's borders
    // are clear.
    void choose_inside() {
        constexpr int trials = 64;
        double best = -1;
        for (int i = 0; i < trials; ++i) {
            // From near (1, 1, 1), whose octant is the domain of a box, over the sphere.
            const double z = 0.45 + 0.9 * i / trials, angle = 0.65 + i * kPi * (3 - std::sqrt(5.0));
            const double up = z > 1 ? 1 - z : z, r = std::sqrt(1 - up * up);
            const Vec3d d{r * std::cos(angle), r * std::sin(angle), up};
            double nearest = 4;
            for (std::size_t g = 1; g < result_.elements.size(); ++g) {
                const Vec3d off = result_.elements[g] * d - d;
                nearest = std::min(nearest, dot(off, off));
            }
            if (nearest > best * 1.05) {
                best = nearest;
                result_.inside = d;
            }
        }
    }

    const Surface& surface_;
    SymmetryOptions options_;
    Deviation deviation_;
    Symmetry result_;
    PrincipalAxes principal_;
    std::vector<Vec3d> axes_;
    double tolerance_ = 0, chord_ = 0;
    int polishes_left_ = 100;  // of a rough sphere every candidate would take one, and none would pass
};

// Whether a comes before b: the larger first component that differs by more than rounding.
bool before(const Vec3d& a, const Vec3d& b) {
    for (int i = 0; i < 3; ++i)
        if (std::fabs(a[i] - b[i]) > 1e-9) return a[i] > b[i];
    return false;
}

Canonical of_finite(const Symmetry& symmetry, const Vec3d& d) {
    double nearest = -2;
    for (const Matrix3& g : symmetry.elements) nearest = std::max(nearest, dot(symmetry.inside, transpose(g) * d));
    // On a border several images are equally near: the same one for all of them, and the first element that gives it.
    Canonical best;
    bool found = false;
    for (const Matrix3& g : symmetry.elements) {
        const Vec3d c = transpose(g) * d;
        if (dot(symmetry.inside, c) < nearest - 1e-9 || (found && !before(c, best.direction))) continue;
        best = {c, g};
        found = true;
    }
    return best;
}

Canonical of_axis(const Symmetry& symmetry, const Vec3d& d) {
    const Vec3d& axis = symmetry.axis;
    const Vec3d u = any_across(axis), v = cross(axis, u);
    double along = dot(d, axis);
    const double x = dot(d, u), y = dot(d, v), across = std::sqrt(x * x + y * y);
    Matrix3 element = across > 1e-12 ? rotation_about(axis, std::atan2(y, x)) : Matrix3{};
    if (symmetry.kind == SymmetryKind::axial_mirrored && along < 0) {
        along = -along;
        element = element * mirror_across(axis);
    }
    return {u * across + axis * along, element};
}

Canonical of_sphere(const Vec3d& d) {
    const Vec3d pole{0, 0, 1}, across = cross(pole, d);
    const double sine = length(across);
    if (sine > 1e-12) return {pole, rotation_about(across / sine, std::atan2(sine, d.z))};
    return {pole, d.z > 0 ? Matrix3{} : rotation_about({1, 0, 0}, kPi)};
}

}  // namespace

const char* name_of(SymmetryKind kind) {
    switch (kind) {
        case SymmetryKind::axial:
            return "axial";
        case SymmetryKind::axial_mirrored:
            return "axial_mirrored";
        case SymmetryKind::spherical:
            return "spherical";
        default:
            return "finite";
    }
}

Symmetry find_symmetry(const Surface& surface, const SymmetryOptions& options) {
    if (surface.triangles.empty()) throw BakeError("symmetry: the surface has no triangles");
    if (!(options.tolerance > 0 && options.tolerance < 0.1 && options.chord_tolerance >= 0 &&
          options.chord_tolerance < 0.1))
        throw BakeError("symmetry: tolerances are shares of the body's width, above 0 and below 0.1");
    return Search(surface, options).run();
}

Canonical canonical(const Symmetry& symmetry, const Vec3d& direction) {
    const double norm = length(direction);
    if (!(norm > 0)) throw BakeError("symmetry: a direction must be longer than zero");
    const Vec3d d = direction / norm;
    switch (symmetry.kind) {
        case SymmetryKind::spherical:
            return of_sphere(d);
        case SymmetryKind::axial:
        case SymmetryKind::axial_mirrored:
            return of_axis(symmetry, d);
        default:
            return of_finite(symmetry, d);
    }
}

std::string describe(const Symmetry& symmetry) {
    char text[128];
    const Vec3d& a = symmetry.axis;
    std::size_t rotations = 0;
    switch (symmetry.kind) {
        case SymmetryKind::spherical:
            return "a sphere: any rotation and reflection";
        case SymmetryKind::axial:
        case SymmetryKind::axial_mirrored:
            std::snprintf(text, sizeof text, "round: any rotation about (%.3g, %.3g, %.3g)%s", a.x + 0.0, a.y + 0.0,
                          a.z + 0.0, symmetry.kind == SymmetryKind::axial ? "" : ", and mirrored across it");
            return text;
        default:
            for (const Matrix3& g : symmetry.elements) rotations += determinant(g) > 0;
            if (symmetry.elements.size() == 1) return "none";
            std::snprintf(text, sizeof text, "%zu elements: %zu rotations, %zu reflections", symmetry.elements.size(),
                          rotations, symmetry.elements.size() - rotations);
            return text;
    }
}

}  // namespace frm::bake
