// Worlds, maps and bodies to test with, in core's own terms.
#pragma once

#include <memory>
#include <memory_resource>

#include "bake/map/fill.h"
#include "bake/map/formula.h"
#include "bake/regions/tessellate.h"
#include "core/world/world.h"
#include "tests/support/shapes.h"

namespace frm::test {

inline std::pmr::memory_resource* memory() { return std::pmr::get_default_resource(); }

inline std::shared_ptr<const Map> map_of(const bake::Surface& surface, std::uint32_t sources = 12,
                                         std::uint32_t frequency = 2, std::uint32_t samples = 32) {
    return std::make_shared<Map>(bake::formula_map(surface, sources, frequency, samples));
}

/// A map with all that a map can have, from the formula: means of 38 directions at three speeds (each speed's pressure is
/// 1 + k times what the base speed's law gives), fluctuations of 18 directions, a spin table, added mass.
inline Map full_map(const bake::Surface& surface, std::uint32_t sources = 8, std::uint32_t samples = 16,
                    double budget = 1e-4, bake::Tables* tables_out = nullptr) {
    const Map coarse = bake::formula_map(surface, sources, 2, samples);
    Map map = bake::formula_map(surface, sources, 3, samples);
    const float u0 = map.facts.base_speed;
    map.fluctuation_directions = coarse.fluctuation_directions;
    map.speeds.assign({0.1f * u0, u0, 3 * u0});
    bake::Tables tables;
    for (std::size_t k = 0; k < 3; ++k) {
        const float ratio = map.speeds[k] / u0, factor = k == 1 ? 1.0f : 1 + static_cast<float>(k + 1);
        for (const SourceForce& f : map.mean)
            tables.mean.push_back({f.pressure * (factor * ratio * ratio), f.friction * ratio});
    }
    const std::size_t count = sources * samples * Map::components;
    for (std::size_t d = 0; d < coarse.step.size(); ++d) {
        bake::Fluctuation f(count);
        for (std::size_t i = 0; i < count; ++i)
            f[i] = coarse.step[d] * static_cast<float>(coarse.fluctuation[d * count + i]);
        tables.fluctuation.push_back(std::move(f));
    }
    bake::fill_tables(map, tables, budget);
    if (tables_out) *tables_out = tables;
    map.spin.rate = 2;
    map.spin.centre = {0.01f, -0.02f, 0.03f};
    for (std::size_t i = 0; i < 6 * std::size_t{sources}; ++i) {
        const float v = 0.01f * static_cast<float>(i + 1);
        map.spin.force.push_back({{v, -v, 2 * v}, {0.1f * v, 0.2f * v, 0}});
    }
    map.has_added_mass = true;
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j)
            map.added_mass[6 * i + j] =
                i == j ? 1.0 + 0.1 * static_cast<double>(i) : 0.001 * static_cast<double>(i + j);
    map.facts.direction_error_rms = 0.02f;
    map.facts.direction_error_worst = 0.07f;
    map.facts.uncertainty = 0.015f;
    map.complete();
    return map;
}

inline bake::Surface fine_box(const Vec3d& size, double edge) {
    return bake::tessellate(box(size), edge, 20000).surface;
}

/// Rotation by `angle` about an axis of any length.
inline Quat<float> turned(const Vec3d& axis, double angle) {
    const Vec3d n = axis * (std::sin(angle / 2) / length(axis));
    return {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z),
            static_cast<float>(std::cos(angle / 2))};
}

inline BodyDef body_of(std::shared_ptr<const Map> map, const Vec3d& position = {}, const Quat<float>& rotation = {},
                       const Twist& twist = {}) {
    BodyDef def;
    def.map = std::move(map);
    def.pose = {position, rotation};
    def.twist = twist;
    return def;
}

inline WaterDef water_of(std::int32_t cells, float cell, float depth, Border border = Border::absorbing,
                         std::int32_t border_cells = 16) {
    WaterDef def;
    def.field = {cells, cells, cell, depth, border, border_cells};
    return def;
}

/// Steps its waves in every tick: for tests that look at the water right after one.
inline WorldDef stepped() {
    WorldDef def;
    def.skip &= ~static_cast<std::uint32_t>(skip_wave_steps);
    return def;
}

inline World world_of(const WorldDef& def = stepped(), std::uint32_t threads = 1) { return World(def, threads, memory()); }

}  // namespace frm::test
