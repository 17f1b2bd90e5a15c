#include <algorithm>
#include <cmath>
#include <limits>

#include "core/body/body.h"
#include "core/kernels/kernels.h"

namespace frm {
namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
/// Of the water under a body that is looked through for its highest and lowest: more cost more than they save.
constexpr std::int32_t widest_look = 96;

/// The lowest and the highest that the water stands over the body, against the calm level, m.
struct Range {
    float low = 0, high = 0;
    bool finite = true;
    bool bare = false;  ///< somewhere it would be lower than the bed, or may be

    bool flat() const { return low == high; }
};

/// Cells of the water under a body's box and its samples, with those that their edges are interpolated from.
struct Under {
    Rect cells;
    bool wide = false;  ///< or not known: not looked through
};

HeightGrid heights_of(const SurfaceView& surface, const Under& under) {
    const Field& field = *surface.field;
    const float* heights = field.height_row(0);
    if (surface.ahead > 0) {
        // Clusters are sampled a little beyond the body's box too.
        const Rect& c = under.cells;
        const std::int32_t x = (c.i1 - c.i0) / 4 + 2, y = (c.j1 - c.j0) / 4 + 2;
        const Rect around{c.i0 - x, c.j0 - y, c.i1 + x, c.j1 + y};
        if (surface.steps <= 1 || !field.mean_heights(around, surface.step, surface.gravity, surface.steps,
                                                      surface.later, *surface.room, surface.scratch))
            field.heights_ahead(around, surface.rise, surface.bend, surface.scratch);
        heights = surface.scratch;
    }
    return {heights, field.stride(), field.def().nx, field.def().ny, field.level()};
}

float support(const float along[3], const Vec3f& half) {
    return std::fabs(along[0]) * half.x + std::fabs(along[1]) * half.y + std::fabs(along[2]) * half.z;
}

Under under(const Body& body, const SurfaceView& surface, const GridPlacement& at) {
    const Vec3f& half = body.def.map->clusters.sampled;
    const float x = support(at.along_x, half) + 0.51f, y = support(at.along_y, half) + 0.51f;
    constexpr float far = 1e6f;
    if (!(x < far && y < far && std::fabs(at.x) < far && std::fabs(at.y) < far))
        return {{0, 0, surface.field->def().nx, surface.field->def().ny}, true};
    const auto first = [](float v) { return static_cast<std::int32_t>(std::floor(v)); };
    return {{at.i + first(at.x - x), at.j + first(at.y - y), at.i + first(at.x + x) + 1, at.j + first(at.y + y) + 1},
            !(x < widest_look && y < widest_look)};
}

/// Linear waves run lower than the bed where they are higher than the water is deep: there a body meets no water.
Range range_over(const HeightGrid& grid, const Under& body, float bed) {
    if (body.wide) return {-infinite, infinite, true, true};
    Rect r = body.cells;
    if (r.i1 <= 0 || r.j1 <= 0 || r.i0 >= grid.nx || r.j0 >= grid.ny) return {};
    const bool inside = r.i0 >= 0 && r.j0 >= 0 && r.i1 <= grid.nx && r.j1 <= grid.ny;
    r = r.clipped(grid.nx, grid.ny);
    Range range;
    float odd = 0;
    kernels().height_range(grid.height + r.j0 * grid.stride + r.i0, grid.stride, r.i1 - r.i0, r.j1 - r.j0, &range.low,
                           &range.high, &odd);
    range.finite = odd == 0;
    range.low += grid.level, range.high += grid.level;
    range.bare = range.low < bed;
    range.low = std::max(range.low, bed), range.high = std::max(range.high, bed);
    if (!inside) range.low = std::min(range.low, 0.0f), range.high = std::max(range.high, 0.0f);  // beyond the border
    return range;
}

/// Sixteen lanes by a fixed tree.
template <typename T>
T sum_of(const float lanes[kernel_lanes]) {
    T part[kernel_lanes];
    for (std::size_t k = 0; k < kernel_lanes; ++k) part[k] = static_cast<T>(lanes[k]);
    for (std::size_t w = kernel_lanes / 2; w > 0; w /= 2)
        for (std::size_t k = 0; k < w; ++k) part[k] += part[k + w];
    return part[0];
}

/// What is wet, in the map's lengths and the body's frame, about the centre of the body's box.
struct Wet {
    Vec3d force, torque;  ///< integrals of depth n dA and of X x n depth dA
    double area = 0, depth = 0;
};

void add(Wet& wet, const WetLanes& sum) {
    for (int c = 0; c < 3; ++c) {
        wet.force[c] += sum_of<double>(sum.force[c]);
        wet.torque[c] += sum_of<double>(sum.torque[c]);
    }
    wet.depth += sum_of<double>(sum.depth);
}

void set_sources(Body& body, float ratio) {
    const Map& map = *body.def.map;
    const float square = body.def.scale * body.def.scale;
    for (std::size_t l = 0; l < body.sources.size(); ++l) {
        body.sources[l].wet_ratio = ratio;
        body.sources[l].wet_area = ratio * map.region_area[l] * square;
    }
    body.wet_sources = ratio > 0 ? static_cast<std::uint32_t>(body.sources.size()) : 0;
}

/// Forgets a body's wet surface, if it is not forgotten already.
void set_dry(Body& body) {
    body.clipped_triangles = 0;
    if (body.wetness == Wetness::dry) return;
    body.wetness = Wetness::dry;
    set_sources(body, 0);
    body.forces.buoyancy = {};
    body.displaced_volume = body.wet_area = body.wet_height = 0;
}

/// The plane depth(X) = b + a . (X - centroid) over all of a surface.
Wet whole_surface(const WetMoments& m, const BodyLevel& level) {
    const Vec3f up(level.up[0], level.up[1], level.up[2]), c(m.centroid[0], m.centroid[1], m.centroid[2]);
    const float b = level.level - dot(up, c);
    Wet wet;
    for (int k = 0; k < 3; ++k) {
        const auto at = [&](int row, int column) { return static_cast<double>(m.moment[row][column]); };
        const auto sum = [&](int column) {
            return static_cast<double>(b) * at(0, column) - static_cast<double>(up.x) * at(1, column) -
                   static_cast<double>(up.y) * at(2, column) - static_cast<double>(up.z) * at(3, column);
        };
        wet.force[k] = sum(k);
        wet.torque[k] = sum(3 + k);
    }
    wet.area = static_cast<double>(m.area);
    wet.depth = static_cast<double>(b) * wet.area;
    return wet;
}

/// Cluster by cluster: those that are wholly wet by their moments, those that are cut triangle by triangle.
/// No height is sampled lower than `bed`.
Wet clipped_surface(Body& body, const BodyLevel& level, const HeightGrid* grid, const GridPlacement& at, float bed) {
    const Map& map = *body.def.map;
    const Clusters& clusters = map.clusters;
    const Kernels& kernel = kernels();
    const float square = body.def.scale * body.def.scale;
    Wet wet;
    OnLines<WetLanes> moments{}, clips{};
    OnLines<ClusterPlanes> planes{};
    alignas(64) float samples[4 * kernel_lanes];
    float odd = 0, area = 0;
    bool any = false, all = true;
    std::size_t source = 0;
    std::uint32_t clipped_batches = 0;
    const auto finish_source = [&] {
        SourceState& s = body.sources[source];
        s.wet_ratio = all && any ? 1.0f : any ? std::min(1.0f, area / map.region_area[source]) : 0.0f;
        s.wet_area = (all && any ? map.region_area[source] : area) * square;
        body.wet_sources += s.wet_ratio > 0;
        wet.area += static_cast<double>(all && any ? map.region_area[source] : area);
        area = 0, any = false, all = true;
        ++source;
    };
    const std::uint32_t count = clusters.count();
    for (std::uint32_t first = 0; first < count; first += kernel_lanes) {
        const ClusterBlock& block = clusters.blocks[first / kernel_lanes];
        if (grid) {
            kernel.sample_heights(grid, &at, block.point[0][0], block.point[1][0], block.point[2][0], 4 * kernel_lanes,
                                  samples);
            if (bed > -infinite)
                for (float& sample : samples) sample = std::max(sample, bed);
        }
        kernel.measure_clusters(&block, &level, grid ? samples : nullptr, &planes, &moments);
        for (std::uint32_t k = 0; k < kernel_lanes && first + k < count; ++k) {
            while (first + k >= clusters.region_begin[source + 1]) finish_source();
            odd += planes.offset[k];
            if (planes.state[k] == cluster_wet) {
                area += block.area[k];
                any = true;
                continue;
            }
            if (planes.state[k] == cluster_dry) {
                all = false;
                continue;
            }
            alignas(64) float lanes[kernel_lanes] = {};
            std::uint32_t cut = 0;
            for (std::uint32_t b = clusters.first_batch[first + k]; b < clusters.first_batch[first + k + 1]; ++b) {
                cut += kernel.clip_triangles(&clusters.batches[b], planes.offset[k], planes.slope[0][k],
                                             planes.slope[1][k], planes.slope[2][k], &clips, lanes);
                // Lanes are single: they go on in double before thousands of triangles cost digits.
                if (++clipped_batches % 64 == 0) add(wet, clips), clips = {};
            }
            body.clipped_triangles += cut;
            const float part = sum_of<float>(lanes);
            // With no triangle cut they are all wet, or some are dry: those are more of the area than digits are.
            const bool whole = cut == 0 && part > block.area[k] * (1 - 1e-5f);
            area += whole ? block.area[k] : part;
            all = all && whole;
            any |= part > 0;
        }
    }
    finish_source();
    add(wet, moments);
    add(wet, clips);
    if (!std::isfinite(odd)) body.water_finite = false;
    return wet;
}

}  // namespace

void measure_wet_surface(Body& body, const SurfaceView& surface, const Fluid& fluid, std::uint32_t skip) {
    const Map& map = *body.def.map;
    const float scale = body.def.scale, inverse = 1 / scale;
    body.water_finite = true;
    body.by_one_evaluation = false;
    if (surface.everywhere) {
        set_sources(body, 1);
        body.wetness = Wetness::whole;
        body.clipped_triangles = 0;
        body.forces.buoyancy = {};
        body.displaced_volume = 0;
        body.wet_area = map.clusters.whole.area * scale * scale;
        body.wet_height = 0;
        return;
    }

    const Clusters& clusters = map.clusters;
    const Vec3f arm = body.rotation.to_world(clusters.centre * scale), &up = body.rotation.row2;
    const float centre_level = surface.level - arm.z, reach = clusters.radius * scale;
    const float along_up[3] = {up.x, up.y, up.z};
    const float height = std::min(reach, support(along_up, clusters.half) * scale * (1 + 1e-6f));
    Range range;
    GridPlacement at{};
    HeightGrid grid{};
    const float bed = surface.field ? -surface.field->def().depth : -infinite;
    if (surface.field) {
        at = placement(body, surface.origin, surface.cells_per_metre);
        const Under cells = under(body, surface, at);
        grid = heights_of(surface, cells);
        range = range_over(grid, cells, bed);
        if (!range.finite) {
            body.water_finite = false;
            return;
        }
    }
    // Between its samples a cluster takes the water for a plane, which elsewhere on it may lie higher or lower than they.
    // Where that decides, the clusters are asked: the force would jump by up to a hundredth of rho g V.
    const float beyond = clusters.overshoot * (range.high - range.low);
    if (centre_level + (range.high + beyond) <= -height) return set_dry(body);

    // A wholly wet body's depths are counted from its own centre's: over a closed surface an even pressure has no force
    // and no moment, and a metre of depth more would only cost digits.
    const bool all_wet = centre_level + (range.low - beyond) > height;
    const float plane = centre_level + (range.flat() ? range.low : 0.0f);  // else waves are sampled
    // Under waves the clusters' planes are laid so far above the body that each counts as wet, whatever their slopes.
    const float above = 4 * clusters.radius + (4 * (range.high - range.low) + beyond - range.low) * inverse;
    const bool at_once = all_wet && range.flat() && (skip & skip_wet_bodies) != 0;
    const float rest = !all_wet ? plane * inverse : at_once ? 0.0f : above;
    const BodyLevel level{rest, {up.x, up.y, up.z}, inverse};
    Wet wet;
    body.by_one_evaluation = at_once;
    if (at_once) {
        body.clipped_triangles = 0;
        if (body.wetness != Wetness::whole) set_sources(body, 1);
        wet = whole_surface(clusters.whole, level);
        body.wetness = Wetness::whole;
    } else {
        body.clipped_triangles = body.wet_sources = 0;
        wet = clipped_surface(body, level, surface.field && !range.flat() ? &grid : nullptr, at,
                              range.bare ? bed : -infinite);
        body.wetness = Wetness::partly;
        if (body.wet_sources == 0) return set_dry(body);
        if (all_wet) set_sources(body, 1), body.wetness = Wetness::whole;
    }

    const double s = static_cast<double>(scale), volume = s * s * s;
    const double weight = -static_cast<double>(fluid.density) * static_cast<double>(fluid.gravity);
    const Vec3d force = wet.force * (volume * weight), torque = wet.torque * (volume * s * weight);
    const Vec3f turned = body.rotation.to_world(Vec3f(force));
    body.forces.buoyancy = {turned, body.rotation.to_world(Vec3f(torque)) + cross(arm, turned)};
    body.displaced_volume = static_cast<float>(-dot(wet.force, Vec3d(up)) * volume);
    body.wet_area = static_cast<float>(wet.area * s * s);
    const float mean_depth = wet.area > 0 ? static_cast<float>(wet.depth / wet.area * s) : 0.0f;
    body.wet_height = wet.area > 0 ? arm.z + level.level * scale - mean_depth : 0.0f;
}

}  // namespace frm
