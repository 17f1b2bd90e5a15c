#include "bake/directions/transfer.h"

#include <cmath>

namespace frm::bake {
namespace {

struct Facet {
    Vec3d centre, normal;
    double area;
};

std::vector<Facet> facets_of(const Surface& surface) {
    std::vector<Facet> facets;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Vec3d a = surface.corner(t, 0), b = surface.corner(t, 1), c = surface.corner(t, 2);
        const Vec3d n = cross(b - a, c - a);
        const double twice = length(n);
        facets.push_back({(a + b + c) / 3.0, twice > 0 ? n / twice : Vec3d{}, 0.5 * twice});
    }
    return facets;
}

/// The facet nearest to a point, of those that face the same way: a thin blade's other side is nearer than it should be.
std::size_t nearest(const std::vector<Facet>& facets, const Vec3d& point, const Vec3d& normal) {
    constexpr double same_way = 0.7;  // cosine
    std::size_t best = 0;
    double least = HUGE_VAL;
    for (const bool any : {false, true}) {
        for (std::size_t t = 0; t < facets.size(); ++t) {
            const Vec3d apart = facets[t].centre - point;
            double square = dot(apart, apart);
            if (dot(facets[t].normal, normal) < same_way && !any) continue;
            if (square < least) {
                least = square;
                best = t;
            }
        }
        if (least < HUGE_VAL) break;
    }
    return best;
}

}  // namespace

Transfer::Transfer(const Surface& surface, const Regions& patches, const Regions& regions, const Vec3d& centre,
                   const Matrix3& g)
    : g_(g) {
    const std::vector<Facet> facets = facets_of(surface);
    const Matrix3 back = transpose(g);
    std::vector<double> area(std::size_t{patches.count} * regions.count, 0.0), covered(patches.count, 0.0);
    for (std::size_t t = 0; t < facets.size(); ++t) {
        const std::size_t from = nearest(facets, centre + back * (facets[t].centre - centre), back * facets[t].normal);
        const std::uint32_t patch = patches.region[from];
        area[std::size_t{patch} * regions.count + regions.region[t]] += facets[t].area;
        covered[patch] += facets[t].area;
    }
    // A patch so small that no triangle's middle lies in its image gives its force to the region under its own middle.
    for (std::size_t t = 0; t < facets.size(); ++t) {
        const std::uint32_t patch = patches.region[t];
        if (covered[patch] > 0) continue;
        const std::size_t to = nearest(facets, centre + g * (facets[t].centre - centre), g * facets[t].normal);
        area[std::size_t{patch} * regions.count + regions.region[to]] = covered[patch] = 1;
    }
    for (std::uint32_t p = 0; p < patches.count; ++p)
        for (std::uint32_t l = 0; l < regions.count; ++l)
            if (const double part = area[std::size_t{p} * regions.count + l]; part > 0)
                shares_.push_back({p, l, part / covered[p]});
}

}  // namespace frm::bake
