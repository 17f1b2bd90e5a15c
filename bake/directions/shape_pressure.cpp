#include "bake/directions/shape_pressure.h"

#include "bake/regions/patches.h"

namespace frm::bake {
namespace {

/// The pressure of each term where the cosine between the stream and the inward normal is c > 0.
std::array<double, ShapePressure::terms> pressures(double c) { return {c, c * c, c * c * c}; }

/// What faces the stream, with the pressures on it.
template <typename Parts, typename Use>
void each_to_windward(const Parts& parts, const Vec3d& e, const Use& use) {
    for (const auto& part : parts) {
        const double c = -dot(part.normal, e);
        if (c > 0) use(part, pressures(c));
    }
}

}  // namespace

ShapePressure::ShapePressure(const Surface& surface, const Regions& regions, const Vec3d& centre)
    : regions_(regions.count) {
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Facet facet = facet_of(surface, t);
        parts_.push_back({regions.region[t], facet.normal, facet.centre - centre, facet.area});
    }
}

std::vector<ShapePressure::Term> ShapePressure::on_regions(const Vec3d& e) const {
    std::vector<Term> out(regions_);
    each_to_windward(parts_, e, [&](const Part& part, const auto& pressure) {
        for (std::size_t k = 0; k < terms; ++k) out[part.region][k] -= part.normal * (part.area * pressure[k]);
    });
    return out;
}

std::vector<FitValue> ShapePressure::on_body(const Vec3d& e, double size) const {
    std::vector<FitValue> out(terms);
    each_to_windward(parts_, e, [&](const Part& part, const auto& pressure) {
        for (std::size_t k = 0; k < terms; ++k) {
            const Vec3d force = part.normal * (-part.area * pressure[k]);
            const Vec3d torque = cross(part.arm, force) / size;
            for (int i = 0; i < 3; ++i) {
                out[k][static_cast<std::size_t>(i)] += force[i];
                out[k][static_cast<std::size_t>(i) + 3] += torque[i];
            }
        }
    });
    return out;
}

}  // namespace frm::bake
