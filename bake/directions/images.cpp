#include "bake/directions/images.h"

#include <algorithm>
#include <cmath>

#include "core/map/directions.h"

namespace frm::bake {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double same_direction = 1e-6;  // chord
constexpr int turns_about_stream = 4;    // of a sphere's images: its own asymmetry averages out

/// Of a sphere's images: its forces turn with the stream, so more of them say nothing new.
constexpr double most_frequency = 3;

/// Files isometries under the direction that they make of `direction`.
class Gatherer {
public:
    explicit Gatherer(const Vec3d& direction) : direction_(direction) {}

    void add(const Matrix3& g) {
        const Vec3d e = g * direction_;
        for (Image& image : images_) {
            if (length(image.direction - e) > same_direction) continue;
            image.by.push_back(g);
            return;
        }
        images_.push_back({e, {g}});
    }
    std::vector<Image> take() { return std::move(images_); }

private:
    Vec3d direction_;
    std::vector<Image> images_;
};

/// The shortest rotation that carries unit vector a to b: two reflections.
Matrix3 turning(const Vec3d& a, const Vec3d& b) {
    const Vec3d middle = a + b;
    const double size = length(middle);
    return mirror_across(size > same_direction ? middle / size : any_across(a)) * mirror_across(a);
}

}  // namespace

std::vector<Image> images(const Symmetry& symmetry, const Vec3d& direction, double spacing) {
    Gatherer out(direction);
    if (symmetry.kind == SymmetryKind::spherical) {
        const auto frequency =
            static_cast<std::uint32_t>(std::clamp(std::ceil(std::sqrt(pi) / spacing), 1.0, most_frequency));
        const DirectionSet lattice(frequency);
        const auto about_stream = [&](const Matrix3& first) {
            const Vec3d e = first * direction;
            for (int k = 0; k < turns_about_stream; ++k)
                out.add(rotation_about(e, 2 * pi * k / turns_about_stream) * first);
        };
        about_stream(Matrix3{});
        for (std::uint32_t d = 0; d < lattice.count(); ++d) about_stream(turning(direction, lattice.direction(d)));
        return out.take();
    }
    if (symmetry.kind == SymmetryKind::finite) {
        for (const Matrix3& g : symmetry.elements) out.add(g);
        return out.take();
    }
    const Vec3d across = cross(symmetry.axis, direction);
    const double sine = length(across);
    const int turns = sine < same_direction
                          ? turns_about_stream
                          : std::max(turns_about_stream, static_cast<int>(std::ceil(2 * pi * sine / spacing)));
    std::vector<Matrix3> mirrors{Matrix3{}};
    if (sine >= same_direction) mirrors.push_back(mirror_across(across / sine));  // in the plane of axis and stream
    if (symmetry.kind == SymmetryKind::axial_mirrored)
        for (std::size_t i = 0, n = mirrors.size(); i < n; ++i)
            mirrors.push_back(mirror_across(symmetry.axis) * mirrors[i]);
    for (int k = 0; k < turns; ++k)
        for (const Matrix3& mirror : mirrors) out.add(rotation_about(symmetry.axis, 2 * pi * k / turns) * mirror);
    return out.take();
}

double apart(const Symmetry& symmetry, const Vec3d& a, const Vec3d& b) {
    const auto angle = [](const Vec3d& u, const Vec3d& v) { return 2 * std::asin(std::min(1.0, 0.5 * length(u - v))); };
    switch (symmetry.kind) {
        case SymmetryKind::spherical:
            return 0;
        case SymmetryKind::finite: {
            double least = pi;
            for (const Matrix3& g : symmetry.elements) least = std::min(least, angle(g * a, b));
            return least;
        }
        default: {
            const auto polar = [&](const Vec3d& v) { return std::acos(std::clamp(dot(v, symmetry.axis), -1.0, 1.0)); };
            const double direct = std::fabs(polar(a) - polar(b));
            const double mirrored = std::fabs(pi - polar(a) - polar(b));
            return symmetry.kind == SymmetryKind::axial_mirrored ? std::min(direct, mirrored) : direct;
        }
    }
}

}  // namespace frm::bake
