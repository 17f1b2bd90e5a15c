#include "bake/regions/region_error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

#include "bake/error.h"
#include "bake/regions/regions.h"

namespace frm::bake {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kAttitudes = 32, kMotions = 4;
constexpr std::size_t kManyTriangles = 10000;              // from here on one motion: a mean over so many needs no more
constexpr std::array<double, 3> kImmersed{0.2, 0.5, 0.8};  // of the surface's area

double fraction(double x) { return x - std::floor(x); }

// Evenly over the sphere, u and v in 0 .. 1.
Vec3d direction(double u, double v) {
    const double z = 1 - 2 * u, r = std::sqrt(std::max(0.0, 1 - z * z));
    return {r * std::cos(2 * kPi * v), r * std::sin(2 * kPi * v), z};
}

// The part of a triangle's area where the depth, linear between its corners, is positive.
double wet_part(double a, double b, double c) {
    if (a < b) std::swap(a, b);
    if (b < c) std::swap(b, c);
    if (a < b) std::swap(a, b);
    if (a <= 0) return 0;
    if (c >= 0) return 1;
    if (b <= 0) return a / (a - b) * (a / (a - c));
    return 1 - c / (c - a) * (c / (c - b));
}

// The depth that about so much of the area is below: `by_depth` has depth and area of each triangle, the deepest first.
// Between the triangles' middles it is linear, so that no rounding decides between two of them.
double depth_above(const std::vector<std::pair<double, double>>& by_depth, double area) {
    double sum = 0;
    for (std::size_t i = 0; i < by_depth.size(); ++i) {
        const double middle = sum + 0.5 * by_depth[i].second;
        if (middle >= area) {
            if (i == 0) return by_depth[0].first;
            const double before = sum - 0.5 * by_depth[i - 1].second;
            const double share = middle > before ? (area - before) / (middle - before) : 0;
            return by_depth[i - 1].first + (by_depth[i].first - by_depth[i - 1].first) * share;
        }
        sum += by_depth[i].second;
    }
    return by_depth.back().first;
}

}  // namespace

RegionJudge::RegionJudge(const Surface& surface) : surface_(surface), centre_(frm::bake::measure(surface).centroid) {
    double moment = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Vec3d a = surface.corner(t, 0), b = surface.corner(t, 1), c = surface.corner(t, 2);
        Facet f;
        f.centre = (a + b + c) / 3.0 - centre_;
        f.normal = cross(b - a, c - a) * 0.5;
        const double size = length(f.normal);
        f.inverse_area = size > 0 ? 1 / size : 0;
        area_ += size;
        moment += size * dot(f.centre, f.centre);
        facets_.push_back(f);
    }
    for (const Vec3d& v : surface.vertices) farthest_ = std::max(farthest_, length(v - centre_));
    radius_ = area_ > 0 ? std::sqrt(moment / area_) : 0;
    if (!(radius_ > 0)) throw BakeError("regions: the surface has no area");
}

// The stream meets a facet at minus its own velocity; half the density is left out, as it is of both sides.
RegionJudge::Load RegionJudge::load_of(const Facet& facet, const Vec3d& velocity, const Vec3d& at) const {
    const double along = dot(facet.normal, velocity) * facet.inverse_area;
    const Vec3d force = facet.normal * (along * along * (along > 0 ? -1.0 : 0.5));
    return {force, cross(at, force)};
}

double RegionJudge::squared(const Load& load) const {
    return dot(load.force, load.force) + dot(load.torque, load.torque) / (radius_ * radius_);
}

// visit(wet part of each triangle, motion)
template <typename Visit>
void RegionJudge::for_each_case(Visit visit) const {
    std::vector<double> depth(surface_.vertices.size()), wet(surface_.triangles.size());
    std::vector<std::pair<double, double>> by_depth(wet.size());
    const int motions = wet.size() < kManyTriangles ? kMotions : 1;
    int number = 0;
    for (int attitude = 0; attitude < kAttitudes; ++attitude) {
        const Vec3d down = direction((attitude + 0.5) / kAttitudes, 0.6180339887498949 * attitude);
        for (std::size_t v = 0; v < depth.size(); ++v) depth[v] = dot(surface_.vertices[v] - centre_, down);
        for (std::size_t t = 0; t < wet.size(); ++t)
            by_depth[t] = {dot(facets_[t].centre, down), facets_[t].inverse_area > 0 ? 1 / facets_[t].inverse_area : 0};
        std::sort(by_depth.begin(), by_depth.end(), std::greater<>());
        for (const double part : kImmersed) {
            const double level = -depth_above(by_depth, part * area_);
            for (std::size_t t = 0; t < wet.size(); ++t) {
                const Triangle& corner = surface_.triangles[t];
                wet[t] = wet_part(depth[corner[0]] + level, depth[corner[1]] + level, depth[corner[2]] + level);
            }
            for (int m = 0; m < motions; ++m, ++number) {
                // A Kronecker sequence over both directions (the fourth generalised golden ratio).
                const double k = number + 0.5;
                const Vec3d linear = direction(fraction(0.8566748838545029 * k), fraction(0.7338918566271260 * k));
                const Vec3d axis = direction(fraction(0.6287067210378087 * k), fraction(0.5385972572236101 * k));
                visit(wet, Motion{linear, axis / farthest_});
            }
        }
    }
}

RegionErrors RegionJudge::measure(const Regions& regions) const {
    const std::vector<RegionProperties> properties = region_properties(surface_, regions);
    std::vector<double> wet_area(regions.count);
    double reference = 0, whole = 0, wet_ratio = 0, velocity = 0, arm = 0;
    for_each_case([&](const std::vector<double>& wet, const Motion& motion) {
        std::fill(wet_area.begin(), wet_area.end(), 0.0);
        for (std::size_t t = 0; t < wet.size(); ++t)
            if (facets_[t].inverse_area > 0) wet_area[regions.region[t]] += wet[t] / facets_[t].inverse_area;
        Load exact, all, by_ratio, by_velocity, by_arm;
        const auto add = [](Load& sum, const Load& load, double share) {
            sum.force += load.force * share;
            sum.torque += load.torque * share;
        };
        for (std::size_t t = 0; t < wet.size(); ++t) {
            const Facet& f = facets_[t];
            const RegionProperties& region = properties[regions.region[t]];
            const double ratio = region.area > 0 ? wet_area[regions.region[t]] / region.area : 0;
            if (!(ratio > 0)) continue;
            const Vec3d source = region.centre - centre_;
            const Load here = load_of(f, motion.linear + cross(motion.angular, f.centre), f.centre);
            const Vec3d at_source = motion.linear + cross(motion.angular, source);
            const Load there = load_of(f, at_source, f.centre);
            add(exact, here, wet[t]);
            add(by_ratio, here, ratio);
            add(by_velocity, there, wet[t]);
            add(by_arm, {here.force, cross(source, here.force)}, wet[t]);
            add(all, {there.force, cross(source, there.force)}, ratio);
        }
        const auto off = [&](const Load& load) {
            return squared({load.force - exact.force, load.torque - exact.torque});
        };
        reference += squared(exact);
        whole += off(all);
        wet_ratio += off(by_ratio);
        velocity += off(by_velocity);
        arm += off(by_arm);
    });
    const auto share = [&](double sum) { return reference > 0 ? std::sqrt(sum / reference) : 0; };
    return {share(whole), share(wet_ratio), share(velocity), share(arm)};
}

}  // namespace frm::bake
