// Worlds, maps and bodies to test with, in core's own terms.
#pragma once

#include <memory>
#include <memory_resource>

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

inline World world_of(const WorldDef& def = {}, std::uint32_t threads = 1) { return World(def, threads, memory()); }

}  // namespace frm::test
