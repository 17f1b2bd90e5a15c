#include "bake/directions/landing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "bake/error.h"

namespace frm::bake {

Landing::Landing(const Surface& surface, double tolerance)
    : surface_(surface), tree_(surface.vertices, surface.triangles) {
    if (!(tolerance >= 0)) throw BakeError("directions: the tolerance must not be less than 0 m");
    const SurfaceProperties shape = measure(surface);
    tolerance_ = std::max(tolerance, 1e-6 * length(shape.high - shape.low));
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) facets_.push_back(facet_of(surface, t));
}

std::uint32_t Landing::find(const Vec3d& centre, const Vec3d& normal) const {
    const double nearest = std::sqrt(tree_.squared_distance(centre, std::numeric_limits<double>::max()));
    const double reach = nearest + 2 * tolerance_;
    const Vec3d margin{reach, reach, reach};
    std::uint32_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    tree_.in_box({centre - margin, centre + margin}, [&](std::uint32_t t) {
        const double away =
            std::sqrt(squared_distance(surface_.corner(t, 0), surface_.corner(t, 1), surface_.corner(t, 2), centre));
        const double cost = away + 2 * tolerance_ * (1 - dot(facets_[t].normal, normal));
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

}  // namespace frm::bake
