// The Fluid Resistance Map in memory: the object's sample triangles, its haptic sources, and what a uniform stream of
// the base speed does to each source, from every direction of the set, over one period (R_p and R_f of Eq. 6).
#pragma once

#include <array>
#include <cstdint>
#include <memory_resource>
#include <string>
#include <vector>

#include "core/map/directions.h"
#include "core/math/vec.h"

namespace frm {

/// The pressure and friction force on one source, N, body frame.
struct SourceForce {
    Vec3f pressure;
    Vec3f friction;
};

/// A haptic source stands for one region of the surface, at its area-weighted centroid.
struct Source {
    Vec3f position;
    Vec3f normal;  ///< area-weighted mean
    float area = 0;
};

struct MapFacts {
    float base_speed = 0;        ///< u0, m/s
    float period = 0;            ///< s
    float density = 0;           ///< kg/m^3
    float viscosity = 0;         ///< kinematic, m^2/s
    float reference_length = 0;  ///< m
    float reynolds = 0;
    float reynolds_solved = 0;
    float quantisation_error = 0;  ///< largest error of the whole force, share of its peak
};

/// Geometry of the whole surface, worked out from the triangles when a map is complete.
struct MapShape {
    double area = 0;
    double volume = 0;
    Vec3d centroid;
    Vec3f low, high;
};

struct Map {
    static constexpr std::uint32_t components = 6;  ///< pressure x, y, z, friction x, y, z
    static constexpr std::uint32_t max_sources = 4096;
    static constexpr std::uint32_t max_samples = 4096;
    static constexpr std::uint32_t max_triangles = 1u << 21;

    explicit Map(std::pmr::memory_resource* memory = std::pmr::get_default_resource());

    MapFacts facts;
    std::pmr::vector<Vec3f> vertices;
    std::pmr::vector<std::array<std::uint32_t, 3>> triangles;  ///< ordered by region
    std::pmr::vector<std::uint32_t> region_begin;              ///< [sources + 1]: triangles of region l start here
    std::pmr::vector<Source> sources;
    DirectionSet directions;
    std::uint32_t samples = 0;
    std::pmr::vector<SourceForce> mean;          ///< [direction][source]
    std::pmr::vector<float> step;                ///< [direction], N: one unit of `fluctuation`
    std::pmr::vector<std::int16_t> fluctuation;  ///< [direction][source][sample][component]
    std::pmr::string provenance;                 ///< JSON text

    // Filled by complete().
    MapShape shape;
    std::pmr::vector<float> triangle_area;  ///< m^2
    std::pmr::vector<float> region_area;    ///< the sum of its triangles'

    std::pmr::vector<std::uint8_t> file;  ///< the bytes it was read from; empty for a map that was made in memory
    std::uint64_t content_hash = 0;

    std::uint32_t source_count() const { return static_cast<std::uint32_t>(sources.size()); }

    /// Checks that everything fits together and is finite, and fills what follows from it. Throws Error
    /// (FRM_ERROR_CORRUPT) naming what does not.
    void complete();
};

}  // namespace frm
