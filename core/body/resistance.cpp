#include <cmath>

#include "core/body/body.h"
#include "core/map/lookup.h"

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

/// What the body's turning adds to its sources: the map's spin table at the body's angular velocity. The water's own
/// rotation is left out: waves have none.
struct Turning {
    DirectionWeights axis{};
    float pressure = 0, friction = 0;  ///< the table's forces times these
    bool any = false;

    Turning() = default;
    /// Pressure goes with rho (w L)^2 L^2, friction with mu (w L) L: one and two lengths more than `similar` has.
    Turning(const Body& body, const Similarity& similar) {
        const float rate = length(body.def.twist.angular), scale = body.def.scale;
        if (!(rate > 0)) return;
        axis = DirectionSet(1).interpolate(body.rotation.to_body(body.def.twist.angular) * (1 / rate));
        const float ratio = rate / body.def.map->spin.rate;
        pressure = ratio * ratio * similar.pressure * scale * scale;
        friction = ratio * similar.friction * scale;
        any = true;
    }
};

/// s_k = (u / u0) dt + s_{k-1}, within one period.
float advance(float time, float by, float period) {
    const float t = time + by;
    if (t < period) return t;
    const float rest = t - std::floor(t / period) * period;
    return rest >= 0 && rest < period ? rest : 0.0f;
}

/// The pressure on the water above a source that faces up (section 6.3): p = -f_p . n / (wet area), by Eq. 3.
void push_up(Footprint& footprint, const SourceState& source, const Vec3f& normal, float depth) {
    const float normal_squared = dot(normal, normal);
    if (!(normal.z > 0) || !(normal_squared > 0) || !(source.wet_area > 0)) return;
    const float p = -dot(source.pressure, normal) / (normal_squared * source.wet_area);
    footprint.splat_pressure(source.position, p, source.wet_area * normal.z / std::sqrt(normal_squared), depth);
}

}  // namespace

void look_up_resistance(Body& body, const SurfaceView& surface, const Fluid& fluid, float dt, std::uint32_t model) {
    const Map& map = *body.def.map;
    const bool own_waves = (model & model_own_waves) != 0, spread = (model & model_displacement) != 0;
    const bool level = (model & model_fluctuation) != 0, speeds = (model & model_speeds) != 0;
    const Similarity similar(map, body.def.scale, fluid);
    const Twist& twist = body.def.twist;
    const Turning turning = map.spin.rate > 0 && (model & model_spin) ? Turning(body, similar) : Turning();
    const SpeedPosition base_speed{map.base, map.base, 0};
    SurfaceView own;
    if (own_waves && body.footprint && body.footprint->active()) {
        own.field = &body.footprint->own;
        own.origin = body.footprint->body_in_window();
        own.cells_per_metre = surface.cells_per_metre;
    }

    Wrench pressure, friction;
    float speed_sum = 0, area_sum = 0;
    for (std::uint32_t l = 0; l < body.sources.size(); ++l) {
        SourceState& source = body.sources[l];
        source.position = body.rotation.to_world(map.sources[l].position * body.def.scale);
        source.pressure = source.friction = source.relative_velocity = {};
        if (!(source.wet_ratio > 0)) continue;  // and the map's time stands still

        const Vec3f water = surface.velocity(source.position) - own.velocity(source.position);
        source.relative_velocity = water - (twist.linear + cross(twist.angular, source.position));
        const float speed = length(source.relative_velocity);
        area_sum += source.wet_area;
        speed_sum += source.wet_area * speed;
        if (speed > 0) {
            const float ratio = speed / map.facts.base_speed;
            source.map_time = advance(source.map_time, ratio * similar.time * dt, map.facts.period);
            const Vec3f direction = body.rotation.to_body(source.relative_velocity) * (1 / speed);
            const SpeedPosition at = speeds ? speed_position(map, speed * similar.speed) : base_speed;
            const SourceForce force =
                look_up(map, l, place_of(map, direction, at, level), sample_position(map, source.map_time));
            source.pressure =
                body.rotation.to_world(force.pressure) * (source.wet_ratio * ratio * ratio * similar.pressure);
            source.friction = body.rotation.to_world(force.friction) * (source.wet_ratio * ratio * similar.friction);
        }
        if (turning.any) {
            const SourceForce force = spin_force(map, l, turning.axis);
            source.pressure += body.rotation.to_world(force.pressure) * (source.wet_ratio * turning.pressure);
            source.friction += body.rotation.to_world(force.friction) * (source.wet_ratio * turning.friction);
        }
        pressure.force += source.pressure;
        pressure.torque += cross(source.position, source.pressure);
        friction.force += source.friction;
        friction.torque += cross(source.position, source.friction);
        if (body.footprint)
            push_up(*body.footprint, source, body.rotation.to_world(map.sources[l].normal),
                    spread ? surface.level - source.position.z : 0.0f);
    }
    body.forces.pressure = pressure;
    body.forces.friction = friction;
    body.relative_speed = area_sum > 0 ? speed_sum / area_sum : 0.0f;
}

}  // namespace frm
