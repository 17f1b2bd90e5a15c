// Bodies for `frm bench frontier` whose force is known to any precision: each triangle obeys one law, so that maps of any
// number of triangles, sources and directions are of one and the same object.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "bake/mesh/surface.h"
#include "core/math/vec.h"

namespace frm::cli {

using MapFile = std::shared_ptr<const std::vector<std::uint8_t>>;

struct LawMap {
    std::uint32_t sources = 0;
    std::uint32_t frequency = 8;  ///< of the directions of the means; 8 is that of a standard bake
    double rounding = 5e-3;       ///< share of the peak force, as fill_tables() takes it; that of a bake
};

/// A map file. Law of a triangle of normal n and area A in a stream u: pressed by rho / 2 (u . n)^2 A where the stream
/// meets it, sucked at half of that at the lee, as for bake/regions/region_error.h; rubbed by 0.01 rho / 2 |u| u A. A
/// source has the sum over its region; what that loses of the torque is given back as in a bake. The fluctuation is a sine
/// of a tenth of the mean.
MapFile law_map(const bake::Surface& surface, const LawMap& settings);

/// A box about `centre` of about so many triangles.
bake::Surface box_surface(const Vec3d& size, const Vec3d& centre, std::uint32_t triangles);

/// 8 n^2 triangles with all corners on the ellipsoid.
bake::Surface ellipsoid_surface(const Vec3d& half_axes, std::uint32_t n);

}  // namespace frm::cli
