#include "core/map/tables.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/map/map.h"

namespace frm {

MapTables::MapTables(std::pmr::memory_resource* memory)
    : position{std::pmr::vector<float>(memory), std::pmr::vector<float>(memory), std::pmr::vector<float>(memory)},
      corners(memory),
      swing_corners(memory),
      mean(memory),
      swing(memory),
      spin(memory),
      steady(memory) {}

namespace {

ForceRow row_of(const SourceForce& f) {
    return {{f.pressure.x, f.pressure.y, f.pressure.z, 0, f.friction.x, f.friction.y, f.friction.z, 0}};
}

void fill_corners(const DirectionSet& set, std::pmr::vector<FaceCorners>& out) {
    out.resize(set.faces());
    for (std::uint32_t f = 0; f < set.faces(); ++f) {
        const auto corner = set.corners(f);
        out[f] = {{corner[0], corner[1], corner[2]}};
    }
}

void fill_swing(const Map& map, std::pmr::vector<SwingRow>& out) {
    const std::size_t samples = map.samples, rows = map.fluctuation_directions.count() * map.sources.size();
    out.resize(rows * (samples + 1));
    for (std::size_t r = 0; r < rows; ++r) {
        for (std::size_t s = 0; s <= samples; ++s) {
            const std::int16_t* v = map.fluctuation.data() + (r * samples + (s < samples ? s : 0)) * Map::components;
            out[r * (samples + 1) + s] = {{v[0], v[1], v[2], 0, v[3], v[4], v[5], 0}};
        }
    }
}

/// Of a source, N: the largest that its pressure and its friction swing, as strong as a blend may be made.
struct Swing {
    double pressure = 0, friction = 0;
};

Swing largest_swing(const Map& map, std::size_t source) {
    Swing most;
    for (std::size_t d = 0; d < map.step.size(); ++d) {
        const std::int16_t* v =
            map.fluctuation.data() + (d * map.sources.size() + source) * map.samples * Map::components;
        const double step = 2 * static_cast<double>(map.step[d]);
        for (std::uint32_t s = 0; s < map.samples; ++s, v += Map::components) {
            most.pressure = std::max(most.pressure, step * length(Vec3d(v[0], v[1], v[2])));
            most.friction = std::max(most.friction, step * length(Vec3d(v[3], v[4], v[5])));
        }
    }
    return most;
}

/// Of the force on the whole body over the directions of a speed.
Swing largest_mean(const Map& map, std::size_t speed) {
    Swing most;
    const std::size_t sources = map.sources.size(), count = map.directions.count();
    for (std::size_t d = 0; d < count; ++d) {
        Vec3d pressure, friction;
        for (std::size_t l = 0; l < sources; ++l) {
            pressure += Vec3d(map.mean[(speed * count + d) * sources + l].pressure);
            friction += Vec3d(map.mean[(speed * count + d) * sources + l].friction);
        }
        most.pressure = std::max(most.pressure, length(pressure));
        most.friction = std::max(most.friction, length(friction));
    }
    return most;
}

double largest_friction(const Map& map, std::size_t source) {
    double most = 0;
    for (std::size_t i = source; i < map.mean.size(); i += map.sources.size())
        most = std::max(most, length(Vec3d(map.mean[i].friction)));
    return most;
}

}  // namespace

void MapTables::fill(const Map& map) {
    const std::size_t count = map.sources.size();
    for (int k = 0; k < 3; ++k) {
        position[k].assign((count + lookup_block - 1) / lookup_block * lookup_block, 0.0f);
        for (std::size_t l = 0; l < count; ++l) position[k][l] = map.sources[l].position[k];
    }
    reach = 0;
    for (const Source& source : map.sources) reach = std::max(reach, length(source.position));
    fill_corners(map.directions, corners);
    fill_corners(map.fluctuation_directions, swing_corners);
    mean.resize(map.mean.size());
    std::transform(map.mean.begin(), map.mean.end(), mean.begin(), row_of);
    spin.resize(map.spin.force.size());
    std::transform(map.spin.force.begin(), map.spin.force.end(), spin.begin(), row_of);
    fill_swing(map, swing);

    std::pmr::vector<Swing> most(count, mean.get_allocator());
    double friction = 0;
    Swing all;
    any_swing = false;
    for (std::size_t l = 0; l < count; ++l) {
        most[l] = largest_swing(map, l);
        friction += largest_friction(map, l) + most[l].friction;
        all.pressure += most[l].pressure, all.friction += most[l].friction;
        any_swing |= most[l].pressure > 0 || most[l].friction > 0;
    }
    Swing peak = largest_mean(map, 0);
    for (std::size_t k = 1; k < map.speeds.size(); ++k) {
        const Swing here = largest_mean(map, k);
        peak = {std::min(peak.pressure, here.pressure), std::min(peak.friction, here.friction)};
    }
    peak_pressure = static_cast<float>(peak.pressure);
    friction_sum = static_cast<float>(friction);
    swing_pressure = static_cast<float>(all.pressure);
    swing_friction = static_cast<float>(all.friction);

    // Pressure and friction each within their own budget, because they go with the speed differently.
    const auto share = [&](const Swing& s) {
        const double p = s.pressure > 0 ? s.pressure / peak.pressure : 0,
                     f = s.friction > 0 ? s.friction / peak.friction : 0;
        return std::max(p, f);
    };
    std::pmr::vector<std::uint32_t> order(count, mean.get_allocator());
    std::iota(order.begin(), order.end(), 0u);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return share(most[a]) < share(most[b]); });
    steady.assign(count, 0);
    steady_sources = 0;
    double left = static_cast<double>(skip_share);
    for (const std::uint32_t l : order) {
        left -= share(most[l]);
        if (!(left >= 0)) break;
        steady[l] = 1;
        ++steady_sources;
    }
}

LookupTable lookup_table(const Map& map) {
    const MapTables& t = map.tables;
    LookupTable out;
    out.sources = map.source_count();
    out.samples = map.samples;
    out.speeds = static_cast<std::uint32_t>(map.speeds.size());
    out.base = map.base;
    out.frequency = static_cast<std::int32_t>(map.directions.frequency());
    out.swing_frequency = static_cast<std::int32_t>(map.fluctuation_directions.frequency());
    out.one_set = map.one_direction_set();
    out.x = t.position[0].data();
    out.y = t.position[1].data();
    out.z = t.position[2].data();
    out.corners = t.corners.data();
    out.swing_corners = t.swing_corners.data();
    out.mean = t.mean.data();
    out.swing = t.swing.data();
    out.step = map.step.data();
    out.level = map.levels.data();
    out.spin = t.spin.empty() ? nullptr : t.spin.data();
    out.steady = t.steady.data();
    out.period = map.facts.period;
    out.samples_per_second = static_cast<float>(map.samples) / map.facts.period;
    for (std::size_t k = 0; k < map.log_speed.size(); ++k) {
        out.log_speed[k] = map.log_speed[k];
        if (k == 0) continue;
        const float between = map.log_speed[k] - map.log_speed[k - 1];
        out.per_log[k - 1] = between > 0 ? 1 / between : 1e30f;  // two speeds may have one logarithm
    }
    return out;
}

}  // namespace frm
