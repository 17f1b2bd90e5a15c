#include <algorithm>
#include <cmath>
#include <functional>

#include "core/body/body.h"
#include "core/body/clip.h"

namespace frm {
namespace {

/// Sums over the wet surface, in double so that thousands of small triangles do not lose the last digits of a large
/// force.
class WetSum {
public:
    explicit WetSum(bool buoyant) : buoyant_(buoyant) {}

    /// The triangle whose pieces come next: its outward vector area and the length of that.
    void begin(const Vec3f& vector_area, float area) { vector_area_ = vector_area, area_ = area; }

    /// A wholly wet piece of the triangle. Pressure is linear over it, so that
    ///   integral d dA = A (d1 + d2 + d3) / 3,  integral r d dA = A / 12 [(sum r)(sum d) + sum r d].
    void operator()(const Corner& a, const Corner& b, const Corner& c, float share) {
        const float area = share * area_;
        wet_area += static_cast<double>(area);
        height_moment += static_cast<double>(area * (a.at.z + b.at.z + c.at.z) * (1.0f / 3));
        if (!buoyant_) return;
        const Vec3f vector_area = vector_area_ * share;
        const float depths = a.depth + b.depth + c.depth;
        force += Vec3d(vector_area * (depths * (1.0f / 3)));
        const Vec3f arm =
            ((a.at + b.at + c.at) * depths + (a.at * a.depth + b.at * b.depth + c.at * c.depth)) * (1.0f / 12);
        torque += Vec3d(cross(arm, vector_area));
    }

    Vec3d force, torque;  ///< per unit of density * gravity, and outward
    double wet_area = 0;
    double height_moment = 0;

private:
    bool buoyant_;
    Vec3f vector_area_;
    float area_ = 0;
};

}  // namespace

void measure_wet_surface(Body& body, const SurfaceView& surface, const Fluid& fluid) {
    const Map& map = *body.def.map;
    const float scale = body.def.scale;
    // A wholly wet body's depths are counted from its own origin's: over a closed surface an even pressure has no force
    // and no moment, and a metre of depth more would only cost digits.
    float least = 0, most = 0, sum_of_depths = 0;
    for (std::size_t i = 0; i < map.vertices.size(); ++i) {
        body.local[i] = body.rotation.to_world(map.vertices[i] * scale);
        body.depth[i] = surface.everywhere ? 1.0f : surface.depth_below_level(body.local[i]);
        least = i == 0 ? body.depth[i] : std::min(least, body.depth[i]);
        most = i == 0 ? body.depth[i] : std::max(most, body.depth[i]);
        sum_of_depths += body.depth[i];
    }
    body.water_finite = std::isfinite(sum_of_depths);
    const bool all_wet = surface.everywhere || surface.level + least > 0, any_wet = all_wet || surface.level + most > 0;
    body.all_wet = all_wet;
    if (!all_wet)
        for (float& d : body.depth) d += surface.level;

    WetSum sum(!surface.everywhere);
    body.clipped_triangles = 0;
    body.wet_sources = 0;
    for (std::size_t l = 0; l < map.sources.size(); ++l) {
        SourceState& source = body.sources[l];
        source.wet_area = 0;
        source.wet_ratio = 0;
        if (!any_wet) continue;
        const double before = sum.wet_area;
        bool partly = false;
        for (std::uint32_t t = map.region_begin[l]; t < map.region_begin[l + 1]; ++t) {
            const auto& index = map.triangles[t];
            if (!all_wet && !(body.depth[index[0]] > 0 || body.depth[index[1]] > 0 || body.depth[index[2]] > 0)) {
                partly = true;
                continue;
            }
            const Corner corner[3] = {{body.local[index[0]], body.depth[index[0]]},
                                      {body.local[index[1]], body.depth[index[1]]},
                                      {body.local[index[2]], body.depth[index[2]]}};
            sum.begin(vector_area_of(corner[0].at, corner[1].at, corner[2].at), map.triangle_area[t] * scale * scale);
            int wet = 3;
            if (all_wet)
                sum(corner[0], corner[1], corner[2], 1.0f);
            else
                wet = add_wet_part(corner, std::ref(sum));
            partly |= wet < 3;
            body.clipped_triangles += wet == 1 || wet == 2;
        }
        source.wet_area = static_cast<float>(sum.wet_area - before);
        const float ratio = source.wet_area / (map.region_area[l] * scale * scale);
        source.wet_ratio = partly ? std::min(1.0f, ratio) : 1.0f;
        body.wet_sources += source.wet_ratio > 0;
    }

    const double weight = -static_cast<double>(fluid.density) * static_cast<double>(fluid.gravity);
    body.forces.buoyancy = {Vec3f(sum.force * weight), Vec3f(sum.torque * weight)};
    body.displaced_volume = static_cast<float>(-sum.force.z);
    body.wet_area = static_cast<float>(sum.wet_area);
    body.wet_height = sum.wet_area > 0 ? static_cast<float>(sum.height_moment / sum.wet_area) : 0.0f;
}

}  // namespace frm
