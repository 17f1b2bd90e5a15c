#include "bake/regions/carry.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "bake/error.h"
#include "bake/mesh/tree.h"

namespace frm::bake {
namespace {

struct Facing {
    Vec3d centre, normal;
};

Facing facing(const Surface& surface, std::size_t t) {
    const Vec3d a = surface.corner(t, 0), b = surface.corner(t, 1), c = surface.corner(t, 2);
    const Vec3d n = cross(b - a, c - a);
    const double size = length(n);
    return {(a + b + c) / 3.0, size > 0 ? n / size : Vec3d{}};
}

// The triangle that a point of the image is on: near it, and facing as the image does.
class Landing {
public:
    Landing(const Surface& surface, double tolerance)
        : surface_(surface), tree_(surface.vertices, surface.triangles), tolerance_(tolerance) {
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) facing_.push_back(facing(surface, t));
    }

    const Facing& facing_of(std::size_t triangle) const { return facing_[triangle]; }

    std::uint32_t find(const Facing& image) const {
        const double nearest = std::sqrt(tree_.squared_distance(image.centre, std::numeric_limits<double>::max()));
        const double reach = nearest + 2 * tolerance_;
        const Vec3d margin{reach, reach, reach};
        std::uint32_t best = 0;
        double least = std::numeric_limits<double>::infinity();
        tree_.in_box({image.centre - margin, image.centre + margin}, [&](std::uint32_t t) {
            const double away = std::sqrt(
                squared_distance(surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2), image.centre));
            const double cost = away + 2 * tolerance_ * (1 - dot(facing_[t].normal, image.normal));
            // Between triangles that are as good (the point is on their common edge), the first.
            const double equal = 1e-6 * tolerance_;
            if (cost < least - equal || (cost < least + equal && t < best)) {
                least = std::min(least, cost);
                best = t;
            }
            return true;
        });
        return best;
    }

private:
    const Surface& surface_;
    Tree tree_;
    double tolerance_;
    std::vector<Facing> facing_;
};

}  // namespace

CarriedRegions carry_regions(const Surface& surface, const Regions& regions, const std::vector<Matrix3>& elements,
                             const Vec3d& centre, double tolerance) {
    if (regions.region.size() != surface.triangles.size()) throw BakeError("regions: they are not of this surface");
    if (!(tolerance > 0)) throw BakeError("regions: the tolerance must be more than 0 m");
    const Landing landing(surface, tolerance);
    CarriedRegions result;
    result.region.resize(elements.size());
    // What a part is known by: the regions that the elements carry it to.
    std::map<std::vector<std::uint32_t>, std::uint32_t> known;
    std::vector<std::uint32_t> carried(elements.size());
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
        const Facing& from = landing.facing_of(t);
        for (std::size_t e = 0; e < elements.size(); ++e) {
            const Matrix3& g = elements[e];
            carried[e] = regions.region[landing.find({centre + g * (from.centre - centre), g * from.normal})];
        }
        const auto [part, added] = known.emplace(carried, result.parts.count);
        if (added) {
            ++result.parts.count;
            for (std::size_t e = 0; e < elements.size(); ++e) result.region[e].push_back(carried[e]);
        }
        result.parts.region.push_back(part->second);
    }
    return result;
}

}  // namespace frm::bake
