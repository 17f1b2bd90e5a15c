#include <algorithm>
#include <cmath>

#include "core/body/resistance.h"
#include "core/kernels/kernels.h"

namespace frm {
namespace {

/// The similarity laws that carry a map to another size and fluid: pressure with density and length^2, friction with
/// dynamic viscosity and length, map time with speed over length.
struct Similarity {
    float pressure, friction, time;
    float speed;  ///< the speed in the map's size and fluid that has the same Reynolds number, of each m/s

    Similarity(const Map& map, float scale, const Fluid& fluid)
        : pressure(fluid.density / map.facts.density * scale * scale),
          friction(fluid.density * fluid.viscosity / (map.facts.density * map.facts.viscosity) * scale),
          time(1 / scale),
          speed(scale * (map.facts.viscosity / fluid.viscosity)) {}
};

/// The pressure on the water above each source that faces up (section 6.3): p = -f_p . n / (wet area), by Eq. 3.
void push_up(Body& body, const SurfaceView& surface, bool spread) {
    const Map& map = *body.def.map;
    for (std::size_t l = 0; l < body.sources.size(); ++l) {
        const Vec3f& normal = map.sources[l].normal;
        const float up = dot(body.rotation.row2, normal), wet_area = body.sources[l].wet_area;
        if (!(up > 0) || !(wet_area > 0) || !(body.sources[l].wet_ratio > 0)) continue;
        const float normal_squared = dot(normal, normal);
        const float p = -dot(body.streams.pressure(l), normal) / (normal_squared * wet_area);
        const Vec3f at = body.rotation.to_world(map.sources[l].position * body.def.scale);
        body.footprint->splat_pressure(at, p, wet_area * up / std::sqrt(normal_squared),
                                       spread ? surface.level - at.z : 0.0f);
    }
}

/// The velocity of the water at each wet source of a block, body frame. Returns the largest.
float sample_water(const Body& body, const SurfaceView& surface, const SurfaceView& own, std::size_t first,
                   LookupBlock& block) {
    const Map& map = *body.def.map;
    float most = 0;
    for (std::size_t s = 0; s < lookup_block && first + s < body.sources.size(); ++s) {
        if (!(block.wet[s] > 0)) continue;
        const Vec3f at = body.rotation.to_world(map.sources[first + s].position * body.def.scale);
        Vec3f water = surface.velocity(at) - own.velocity(at);
        // Linear waves have u = c h / d, and a trough is no deeper than the water: faster than c they mean nothing.
        const float square = dot(water, water);
        if (square > surface.fastest * surface.fastest) water = water * (surface.fastest / std::sqrt(square));
        const Vec3f local = body.rotation.to_body(water);
        block.x[s] = local.x, block.y[s] = local.y, block.z[s] = local.z;
        most = std::max(most, dot(water, water));
    }
    return std::sqrt(most);
}

/// A block's inputs: wet ratios and map times of its sources, and water at rest.
void begin_block(const Body& body, std::size_t first, LookupBlock& block) {
    const std::size_t count = std::min(lookup_block, body.sources.size() - first);
    block.count = static_cast<std::uint32_t>(count);
    for (std::size_t s = 0; s < count; ++s) {
        block.wet[s] = body.sources[first + s].wet_ratio;
        block.time[s] = body.sources[first + s].map_time + body.map_time_owed;
    }
    for (std::size_t s = 0; s < lookup_block; ++s) block.x[s] = block.y[s] = block.z[s] = 0;
}

void set(float (&out)[3], const Vec3f& v) { out[0] = v.x, out[1] = v.y, out[2] = v.z; }

/// Pressure goes with rho (w L)^2 L^2, friction with mu (w L) L: one and two lengths more than `similar` has. The water's
/// own rotation is left out: waves have none.
void add_spin(const Body& body, const Vec3f& rotation, const Similarity& similar, LookupMotion& motion) {
    const float rate = length(rotation), scale = body.def.scale;
    if (!(rate > 0)) return;
    const DirectionWeights axis = DirectionSet(1).interpolate(rotation * (1 / rate));
    const float ratio = rate / body.def.map->spin.rate;
    motion.spinning = true;
    motion.spin_pressure = ratio * ratio * similar.pressure * scale * scale;
    motion.spin_friction = ratio * similar.friction * scale;
    for (int k = 0; k < 3; ++k) motion.spin_axis[k] = axis.index[k], motion.spin_weight[k] = axis.weight[k];
}

LookupMotion motion_of(const Body& body, const Fluid& fluid, float dt, std::uint32_t model, std::uint32_t skip) {
    const Map& map = *body.def.map;
    const Similarity similar(map, body.def.scale, fluid);
    const Vec3f rotation = body.rotation.to_body(body.def.twist.angular);
    LookupMotion m{};
    set(m.velocity, body.rotation.to_body(body.def.twist.linear));
    set(m.rotation, rotation * body.def.scale);
    m.per_base_speed = 1 / map.facts.base_speed;
    m.time = similar.time * dt;
    m.pressure = similar.pressure;
    m.friction = similar.friction;
    m.reynolds_speed = similar.speed;
    m.by_speed = (model & model_speeds) && map.speeds.size() > 1;
    m.keep_level = (model & model_fluctuation) != 0;
    m.swinging = map.tables.any_swing;
    m.skip_steady = (skip & skip_steady) != 0 && map.tables.steady_sources > 0;
    if (map.spin.rate > 0 && (model & model_spin)) add_spin(body, rotation, similar, m);
    return m;
}

/// The largest relative speed that a source of the body can have, over the base speed, where the water runs at `water`.
float largest_ratio(const Body& body, float water, const LookupMotion& m) {
    const Twist& twist = body.def.twist;
    return (length(twist.linear) + length(twist.angular) * (body.def.map->tables.reach * body.def.scale) + water) *
           m.per_base_speed;
}

/// The part of the sums that is a torque about the body's origin: sum of position x force, from the sums of each
/// component of the position times the force, and those of groups about their centres.
Vec3f torque_of(const LookupSum& sum, int first, float scale) {
    const float *x = sum.x.v + first, *y = sum.y.v + first, *z = sum.z.v + first, *own = sum.torque.v + first;
    return Vec3f((y[2] - z[1]) + own[0], (z[0] - x[2]) + own[1], (x[1] - y[0]) + own[2]) * scale;
}

}  // namespace

Wrench wrench_of(const Body& body, const LookupSum& sum, int first) {
    const float* f = sum.force.v + first;
    return {body.rotation.to_world({f[0], f[1], f[2]}), body.rotation.to_world(torque_of(sum, first, body.def.scale))};
}

void look_up_resistance(Body& body, const SurfaceView& surface, const Fluid& fluid, float dt, std::uint32_t model,
                        std::uint32_t skip) {
    const Map& map = *body.def.map;
    const bool own_waves = (model & model_own_waves) != 0, spread = (model & model_displacement) != 0;
    body.streams.rotation = body.rotation;
    body.streams.grouped = false;
    body.skipped = {};
    body.detail = {};
    SurfaceView own;
    if (own_waves && body.footprint && body.footprint->active()) {
        own.field = &body.footprint->own;
        own.origin = body.footprint->body_in_window();
        own.cells_per_metre = surface.cells_per_metre;
        own.pull = surface.pull;
    }

    LookupMotion motion = motion_of(body, fluid, dt, model, skip);
    if ((body.budget.error > 0 || body.budget.time > 0) && body.wet_sources > 0 && surface.still && !own.field &&
        !(body.footprint && body.pushes)) {
        if (const Level* level = choose_level(body, motion)) return look_up_groups(body, *level, motion);
    }

    const std::size_t count = body.sources.size();
    float water = 0;
    for (std::size_t first = 0; first < count; first += lookup_block) {
        LookupBlock& block = body.streams.block[first / lookup_block];
        begin_block(body, first, block);
        if (surface.field || own.field) water = std::max(water, sample_water(body, surface, own, first, block));
    }
    body.map_time_owed = 0;
    if (skip & skip_friction && !motion.spinning)
        motion.skip_friction =
            map.tables.friction_sum * motion.friction <=
            skip_share * map.tables.peak_pressure * motion.pressure * largest_ratio(body, water, motion);

    body.detail.over_budget = body.wet_sources > 0 && is_dear(body, body.wet_sources);
    body.streams.motion = motion;
    const LookupTable table = lookup_table(map);
    const auto look_up_block = kernels().look_up_block;
    LookupSum sum{};
    float speed_sum = 0, area_sum = 0;
    for (std::size_t first = 0; first < count; first += lookup_block) {
        LookupBlock& block = body.streams.block[first / lookup_block];
        look_up_block(table, motion, block, first, sum);
        for (std::size_t s = 0; s < lookup_block && first + s < count; ++s) {
            SourceState& source = body.sources[first + s];
            if (!(source.wet_ratio > 0)) continue;  // and the map's time stands still
            source.map_time = block.time[s];
            area_sum += source.wet_area;
            speed_sum += source.wet_area * block.speed[s];
        }
    }
    if (motion.skip_friction) {
        body.skipped.friction = body.wet_sources;
        for (LookupBlock& block : body.streams.block)
            for (ForceRow& row : block.force) row.v[4] = row.v[5] = row.v[6] = 0;
    }
    if (motion.skip_steady || !map.tables.any_swing)
        for (std::size_t l = 0; l < count; ++l)
            body.skipped.steady += map.tables.steady[l] && body.sources[l].wet_ratio > 0;
    if (body.footprint && body.pushes && !surface.waits) push_up(body, surface, spread);
    body.forces.pressure = wrench_of(body, sum, 0);
    body.forces.friction = wrench_of(body, sum, 4);
    body.relative_speed = area_sum > 0 ? speed_sum / area_sum : 0.0f;
}

SourceReading read_source(const Body& body, std::uint32_t l) {
    const Rotation<float>& r = body.streams.rotation;
    SourceReading out;
    out.position = r.to_world(body.def.map->sources[l].position * body.def.scale);
    if (!(body.sources[l].wet_ratio > 0)) return out;
    const std::size_t in_block = l % lookup_block, first = l - in_block;
    const LookupBlock* block = &body.streams.block[l / lookup_block];
    LookupBlock looked_up{};
    if (body.streams.grouped) {  // the motion of that tick once more, for this source
        LookupSum sum{};
        looked_up.count = static_cast<std::uint32_t>(in_block + 1);
        looked_up.wet[in_block] = body.sources[l].wet_ratio;
        kernels().look_up_block(lookup_table(*body.def.map), body.streams.motion, looked_up, first, sum);
        block = &looked_up;
    }
    const float* f = block->force[in_block].v;
    out.relative_velocity = r.to_world({block->x[in_block], block->y[in_block], block->z[in_block]});
    out.pressure = r.to_world({f[0], f[1], f[2]});
    out.friction = r.to_world({f[4], f[5], f[6]});
    return out;
}

}  // namespace frm
