#include "bake/directions/transfer.h"

#include <algorithm>
#include <cmath>
#include <utility>

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

/// Finds facets by place. They are in the order of a coordinate along which no face of an ordinary body is flat, so that
/// few are as far along it as any one.
class Places {
public:
    explicit Places(const std::vector<Facet>& facets) : facets_(facets) {
        double size = 0;
        for (std::size_t t = 0; t < facets.size(); ++t) {
            order_.push_back({dot(along, facets[t].centre), t});
            size = std::max(size, length(facets[t].centre - facets[0].centre));
        }
        std::sort(order_.begin(), order_.end());
        tie_ = 1e-12 * size * size;
    }

    /// The facet nearest to a point, of those that face the same way: a thin blade's other side is nearer than it should
    /// be. Of facets equally near, the first: images of one another are, and rounding must not choose.
    std::size_t nearest(const Vec3d& point, const Vec3d& normal) const {
        for (const double same_way : {0.7, -HUGE_VAL}) {
            Best best;
            const double place = dot(along, point);
            auto after = std::lower_bound(order_.begin(), order_.end(), std::pair<double, std::size_t>{place, 0});
            auto before = after;
            // Outwards, while what lies there may be as near.
            for (;;) {
                const double up = after != order_.end() ? after->first - place : HUGE_VAL;
                const double down = before != order_.begin() ? place - (before - 1)->first : HUGE_VAL;
                const double next = std::min(up, down);
                if (next == HUGE_VAL || next * next > best.square + tie_) break;
                consider(up <= down ? (after++)->second : (--before)->second, point, normal, same_way, best);
            }
            if (best.square < HUGE_VAL) return best.facet;
        }
        return 0;
    }

private:
    static constexpr Vec3d along{0.6345, 0.5181, 0.5734};  // of length 1, nearly and not above

    struct Best {
        double square = HUGE_VAL;
        std::size_t facet = 0;
    };

    void consider(std::size_t t, const Vec3d& point, const Vec3d& normal, double same_way, Best& best) const {
        if (dot(facets_[t].normal, normal) < same_way) return;
        const Vec3d apart = facets_[t].centre - point;
        const double square = dot(apart, apart);
        if (square < best.square - tie_ || (square <= best.square + tie_ && t < best.facet)) {
            best.square = std::min(square, best.square);
            best.facet = t;
        }
    }

    const std::vector<Facet>& facets_;
    std::vector<std::pair<double, std::size_t>> order_;
    double tie_ = 0;
};

}  // namespace

Transfer::Transfer(const Surface& surface, const Regions& patches, const Regions& regions, const Vec3d& centre,
                   const Matrix3& g)
    : g_(g) {
    const std::vector<Facet> facets = facets_of(surface);
    const Places places(facets);
    const Matrix3 back = transpose(g);
    std::vector<double> area(std::size_t{patches.count} * regions.count, 0.0), covered(patches.count, 0.0);
    for (std::size_t t = 0; t < facets.size(); ++t) {
        const std::size_t from = places.nearest(centre + back * (facets[t].centre - centre), back * facets[t].normal);
        const std::uint32_t patch = patches.region[from];
        area[std::size_t{patch} * regions.count + regions.region[t]] += facets[t].area;
        covered[patch] += facets[t].area;
    }
    // A patch so small that no triangle's middle lies in its image gives its force to the region under its own middle.
    for (std::size_t t = 0; t < facets.size(); ++t) {
        const std::uint32_t patch = patches.region[t];
        if (covered[patch] > 0) continue;
        const std::size_t to = places.nearest(centre + g * (facets[t].centre - centre), g * facets[t].normal);
        area[std::size_t{patch} * regions.count + regions.region[to]] = covered[patch] = 1;
    }
    for (std::uint32_t p = 0; p < patches.count; ++p)
        for (std::uint32_t l = 0; l < regions.count; ++l)
            if (const double part = area[std::size_t{p} * regions.count + l]; part > 0)
                shares_.push_back({p, l, part / covered[p]});
}

}  // namespace frm::bake
