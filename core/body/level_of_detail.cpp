#include <algorithm>
#include <cmath>

#include "core/body/resistance.h"
#include "core/kernels/kernels.h"
#include "core/map/lookup.h"

namespace frm {
namespace {

/// What a lookup costs, by count and not by the clock, so that the same is chosen on every machine: nanoseconds on a Zen 5
/// core that does something else as well.
constexpr float ns_to_begin = 60, ns_a_lookup = 15;

float nanoseconds(std::size_t lookups) { return ns_to_begin + ns_a_lookup * static_cast<float>(lookups); }

float size(const float (&v)[3]) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

/// Mean wet ratio of a group, by area.
float wet_ratio(const Body& body, const Level& level, std::size_t group) {
    const Map& map = *body.def.map;
    float wet = 0, area = 0;
    for (std::uint32_t i = level.begin[group]; i < level.begin[group + 1]; ++i) {
        const std::uint32_t l = map.detail.order[i];
        wet += body.sources[l].wet_ratio * map.sources[l].area;
        area += map.sources[l].area;
    }
    return wet / area;
}

/// N: by how much the force is off because a group's sources are not equally wet.
float wetness_error(const Body& body, const Level& level, const LevelMotion& m) {
    const MapLevels& detail = body.def.map->detail;
    const float fastest = m.speed + m.turning * body.def.map->tables.reach;
    float pressure = 0, friction = 0;
    for (std::size_t g = 0; g < level.groups; ++g) {
        const float wet = wet_ratio(body, level, g);
        for (std::uint32_t i = level.begin[g]; i < level.begin[g + 1]; ++i) {
            const std::uint32_t l = detail.order[i];
            const float off = std::fabs(body.sources[l].wet_ratio - wet);
            pressure += off * detail.most_pressure[l];
            friction += off * detail.most_friction[l];
        }
    }
    return (m.pressure * fastest * pressure + m.friction * friction) * fastest;
}

/// Force and torque rows of the whole body at a place of the map.
struct WholeRows {
    float v[16] = {};

    void add(const ForceRow& force, const ForceRow& torque, float weight) {
        for (int c = 0; c < 8; ++c) v[c] += weight * force.v[c];
        for (int c = 0; c < 8; ++c) v[c + 8] += weight * torque.v[c];
    }
};

/// look_up_block for a level of one group, which is a matter of latency: what follows from what is not worth sixteen
/// numbers at a time.
void look_up_whole(const Body& body, const Level& level, const LookupMotion& m, LookupSum& sum, float& speed) {
    const Map& map = *body.def.map;
    const Vec3f centre(level.position[0][0], level.position[1][0], level.position[2][0]);
    const Vec3f stream = -(Vec3f(m.velocity[0], m.velocity[1], m.velocity[2]) +
                           cross(Vec3f(m.rotation[0], m.rotation[1], m.rotation[2]), centre));
    speed = length(stream);
    const float ratio = speed * m.per_base_speed, wet = body.all_wet() ? 1.0f : wet_ratio(body, level, 0);
    const FacePlace place = map.directions.locate(stream);
    const FaceCorners& corner = map.tables.corners[place.face];
    const std::size_t cells = map.directions.count(), torque = level.rows.size() / 2;
    WholeRows rows;
    const auto add = [&](std::size_t speed_number, float share) {
        for (int k = 0; k < 3; ++k) {
            const ForceRow* row = level.rows.data() + speed_number * cells + corner.index[k];
            rows.add(row[0], row[torque], share * place.weight[k]);
        }
    };
    if (m.by_speed) {
        const SpeedPosition at = speed_position(map, speed * m.reynolds_speed);
        add(at.before, 1 - at.share);
        add(at.after, at.share);
    } else {
        add(map.base, 1);
    }
    const float pressure = wet * ratio * ratio * m.pressure, friction = wet * ratio * m.friction;
    for (int c = 0; c < 16; ++c) rows.v[c] *= c % 8 < 4 ? pressure : friction;
    if (m.spinning) {
        WholeRows spin;
        for (int k = 0; k < 3; ++k)
            spin.add(level.spin[m.spin_axis[k]], level.spin[6 + m.spin_axis[k]], m.spin_weight[k]);
        for (int c = 0; c < 16; ++c) rows.v[c] += spin.v[c] * (wet * (c % 8 < 4 ? m.spin_pressure : m.spin_friction));
    }
    for (int c = 0; c < 8; ++c) {
        sum.force.v[c] = rows.v[c];
        sum.x.v[c] = rows.v[c] * centre.x;
        sum.y.v[c] = rows.v[c] * centre.y;
        sum.z.v[c] = rows.v[c] * centre.z;
        sum.torque.v[c] = rows.v[c + 8];
    }
}

/// Speeds are weighed by wet area, as in look_up_resistance.
void look_up_blocks(const Body& body, const Level& level, const LookupMotion& m, LookupSum& sum, float& speed) {
    const LookupTable table = lookup_table(*body.def.map, level);
    LookupBlock block;  // its forces are not looked at
    float speed_sum = 0, area_sum = 0;
    for (std::size_t first = 0; first < level.groups; first += lookup_block) {
        const std::size_t count = std::min(lookup_block, level.groups - first);
        block.count = static_cast<std::uint32_t>(count);
        for (std::size_t s = 0; s < lookup_block; ++s) {
            block.x[s] = block.y[s] = block.z[s] = block.time[s] = 0;
            block.wet[s] = s >= count ? 0.0f : body.all_wet() ? 1.0f : wet_ratio(body, level, first + s);
        }
        kernels().look_up_block(table, m, block, first, sum);
        for (std::size_t s = 0; s < count; ++s) {
            const float area = block.wet[s] * level.area[first + s];
            area_sum += area;
            speed_sum += area * block.speed[s];
        }
    }
    speed = area_sum > 0 ? speed_sum / area_sum : 0.0f;
}

}  // namespace

bool is_dear(const Body& body, std::size_t lookups) {
    return body.budget.time > 0 && nanoseconds(lookups) > 1000 * body.budget.time;
}

const Level* choose_level(Body& body, const LookupMotion& motion) {
    const Map& map = *body.def.map;
    const float newtons = body.budget.error;
    const LevelMotion m{size(motion.velocity) * motion.per_base_speed, size(motion.rotation) * motion.per_base_speed,
                        motion.pressure, motion.friction};
    const Level* chosen = nullptr;
    for (const Level& level : map.detail.level) {
        if (motion.spinning && !body.all_wet()) break;  // what spin adds to a group is for one wet ratio
        if (chosen && is_dear(body, level.groups)) break;
        chosen = &level;
        body.detail = {level.groups, level.error(m, map.tables.reach), false};
        if (!body.all_wet()) body.detail.error += wetness_error(body, level, m);
        body.detail.over_budget = is_dear(body, level.groups);
        if (newtons > 0 && body.detail.error <= newtons) return chosen;
    }
    if (!chosen || !is_dear(body, map.sources.size())) {
        body.detail = {};
        return nullptr;
    }
    body.detail.over_budget = body.detail.over_budget || newtons > 0;
    return chosen;
}

void look_up_groups(Body& body, const Level& level, const LookupMotion& motion) {
    LookupMotion& m = body.streams.motion;
    m = motion;
    m.swinging = m.skip_friction = false;
    m.time = 0;
    body.streams.grouped = true;
    LookupSum sum{};
    if (level.groups == 1)
        look_up_whole(body, level, m, sum, body.relative_speed);
    else
        look_up_blocks(body, level, m, sum, body.relative_speed);
    body.forces.pressure = wrench_of(body, sum, 0);
    body.forces.friction = wrench_of(body, sum, 4);
    body.map_time_owed += body.relative_speed * motion.per_base_speed * motion.time;
}

}  // namespace frm
