// The Fluid Resistance Map in memory: the object's sample triangles, its haptic sources, and what a uniform stream of
// the base speed does to each source, from every direction of the set, over one period (R_p and R_f of Eq. 6). Beyond
// the paper: means at other speeds, what spin adds, added mass.
#pragma once

#include <array>
#include <cstdint>
#include <memory_resource>
#include <string>
#include <vector>

#include "core/map/clusters.h"
#include "core/map/directions.h"
#include "core/map/levels.h"
#include "core/map/tables.h"
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
    float quantisation_error = 0;  ///< largest error of the whole force by rounding, share of its peak
    // What the bake found; 0: not known.
    float direction_error_rms = 0;    ///< of the mean force in directions held out, share of the peak
    float direction_error_worst = 0;  ///< the same, the worst of them
    float uncertainty = 0;            ///< standard error of the mean drag, share, worst direction
};

/// What a turning object feels in still water beyond the local streams of its sources (docs/model.md, 6): the force in
/// water at rest while the object turns about `centre` at `rate`, less what the streams give for the same motion. For
/// each of the six directions of DirectionSet(1), as the angular velocity of the object against the water.
struct SpinTable {
    explicit SpinTable(std::pmr::memory_resource* memory) : force(memory) {}

    float rate = 0;                       ///< w0, rad/s; 0: there is no table
    Vec3f centre;                         ///< m, body frame
    std::pmr::vector<SourceForce> force;  ///< [direction][source]
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
    static constexpr std::uint32_t max_speeds = 16;
    static constexpr std::uint64_t max_means = std::uint64_t{1} << 28;         ///< numbers in all: 1 GiB in memory
    static constexpr std::uint64_t max_fluctuations = std::uint64_t{1} << 31;  ///< numbers in all: 4 GiB in memory

    explicit Map(std::pmr::memory_resource* memory = std::pmr::get_default_resource());

    MapFacts facts;
    std::pmr::vector<Vec3f> vertices;
    std::pmr::vector<std::array<std::uint32_t, 3>> triangles;  ///< ordered by region
    std::pmr::vector<std::uint32_t> region_begin;              ///< [sources + 1]: triangles of region l start here
    std::pmr::vector<Source> sources;
    DirectionSet directions;              ///< of the means
    DirectionSet fluctuation_directions;  ///< of the fluctuations: coarser, or the same
    std::pmr::vector<float> speeds;       ///< m/s, rising; the base speed is one of them
    std::uint32_t samples = 0;
    /// [speed][direction][source], carried to the base speed by the map's own law: pressure measured at speed u times
    /// (u0 / u)^2, friction times u0 / u.
    std::pmr::vector<SourceForce> mean;
    /// [speed][2], N: pressures and frictions are whole multiples, from -32768 to 32767, of these; 0: they are not.
    std::pmr::vector<std::array<float, 2>> mean_step;
    std::pmr::vector<float> step;                ///< [fluctuation direction], N: one unit of `fluctuation`
    std::pmr::vector<std::int16_t> fluctuation;  ///< [fluctuation direction][source][sample][component]
    SpinTable spin;
    bool has_added_mass = false;
    /// Row after row, force x, y, z, torque x, y, z about the body frame's origin; kg, kg m, kg m^2 at facts.density.
    std::array<double, 36> added_mass{};
    std::pmr::string provenance;  ///< JSON text

    // Filled by complete().
    MapShape shape;
    std::pmr::vector<float> region_area;    ///< m^2, the sum of its triangles'
    Clusters clusters;                      ///< of the triangles
    std::uint32_t base = 0;                 ///< which of `speeds` is the base speed
    std::pmr::vector<float> log_speed;      ///< [speed]; empty for one speed
    std::pmr::vector<FaceLevel> levels;     ///< [face of fluctuation_directions]
    MapTables tables;                       ///< all of it as a tick reads it
    MapLevels detail;                       ///< groups of sources, for a tick that may be less exact

    std::uint32_t format_version = 0;     ///< of the file it was read from
    std::pmr::vector<std::uint8_t> file;  ///< the bytes it was read from; empty for a map that was made in memory
    std::uint64_t content_hash = 0;

    std::uint32_t source_count() const { return static_cast<std::uint32_t>(sources.size()); }
    bool one_direction_set() const { return directions.frequency() == fluctuation_directions.frequency(); }

    /// Checks that everything fits together and is finite, and fills what follows from it. Throws Error
    /// (FRM_ERROR_CORRUPT) naming what does not.
    void complete();
};

}  // namespace frm
