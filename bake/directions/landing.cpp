#include "bake/directions/landing.h"

#include <cmath>
#include <limits>

#include "bake/error.h"

namespace frm::bake {
namespace {

Facing facing(const Surface& surface, std::size_t t) {
    const Vec3d a = surface.corner(t, 0), b = surface.corner(t, 1), c = surface.corner(t, 2);
    const Vec3d n = cross(b - a, c - a);
    const double size = length(n);
    return {(a + b + c) / 3.0, size > 0 ? n / size : Vec3d{}};
}

}  // namespace

Landing::Landing(const Surface& surface, double tolerance)
    : surface_(surface), tree_(surface.vertices, surface.triangles), tolerance_(tolerance) {
    if (!(tolerance > 0)) throw BakeError("directions: the tolerance must be more than 0 m");
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) facing_.push_back(facing(surface, t));
}

std::uint32_t Landing::find(const Facing& image) const {
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

}  // namespace frm::bake
