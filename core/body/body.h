// One rigid body in a world: its motion, what of it is wet, and the forces of the last tick.
#pragma once

#include <cstdint>
#include <memory>
#include <memory_resource>
#include <optional>
#include <vector>

#include "core/body/source_streams.h"
#include "core/map/map.h"
#include "core/math/quat.h"
#include "core/model.h"
#include "core/skip.h"
#include "core/water/footprint.h"

namespace frm {

struct Pose {
    Vec3d position;
    Quat<float> rotation;
};

struct Twist {
    Vec3f linear;
    Vec3f angular;
};

/// Force and torque about the body's origin, world axes.
struct Wrench {
    Vec3f force;
    Vec3f torque;
};

struct Forces {
    Wrench total, buoyancy, pressure, friction, gravity;
};

struct BodyDef {
    std::shared_ptr<const Map> map;
    float scale = 1;
    float mass = 0;
    Vec3f centre_of_mass;  ///< body frame, not scaled
    Pose pose;
    Twist twist;
    /// The resistance may be off by so much, N (its torque by that times the distance of the furthest source): where
    /// that suffices, groups of sources are looked up as one. 0: every source by itself.
    float error_budget = 0;
    /// What looking the resistance up may cost, us, counted in lookups of a fixed price and not by the clock, which would
    /// not give the same bits twice. 0: no limit. Goes before error_budget.
    float time_budget = 0;
};

/// The fluid that a body is in.
struct Fluid {
    float gravity = 9.80665f;
    float density = 1000;
    float viscosity = 1e-6f;  ///< kinematic
};

/// What is remembered of one haptic source between ticks.
struct SourceState {
    float map_time = 0;   ///< s of Eq. 6
    float wet_area = 0;   ///< m^2
    float wet_ratio = 0;  ///< alpha of Eq. 6
};

/// What the last tick found at a source.
struct SourceReading {
    Vec3f position;            ///< local: world axes, origin at the body
    Vec3f relative_velocity;   ///< of the water against the source, world axes
    Vec3f pressure, friction;  ///< N, world axes
};

struct Body {
    Body(const BodyDef& def, std::uint32_t id, std::pmr::memory_resource* memory);

    BodyDef def;
    std::uint32_t id;  ///< counts the bodies of a world in the order of creation
    Rotation<float> rotation;
    std::pmr::vector<Vec3f> local;  ///< vertices, scaled and turned: world axes, origin at the body
    std::pmr::vector<float> depth;  ///< of each vertex
    std::pmr::vector<SourceState> sources;
    SourceStreams streams;               ///< of the last tick
    std::optional<Footprint> footprint;  ///< while the world has water

    Forces forces;
    float displaced_volume = 0, wet_area = 0, relative_speed = 0;
    std::uint32_t wet_sources = 0, clipped_triangles = 0;
    /// Sources of the last tick whose friction or fluctuation was left out (core/skip.h).
    struct {
        std::uint32_t friction = 0, steady = 0;
    } skipped;
    /// The level of detail of the last tick.
    struct {
        std::uint32_t groups = 0;  ///< 0: every source by itself
        float error = 0;           ///< N, the bound on what that costs
        bool over_budget = false;  ///< the time did not suffice for error_budget
    } detail;
    float map_time_owed = 0;   ///< s, to all wet sources, of ticks that looked up groups
    bool all_wet = false;      ///< every wet ratio is 1
    bool pushes = true;        ///< it is near enough to the surface to push it
    bool water_finite = true;  ///< the surface around it is a finite number
    float wet_height = 0;      ///< of the wet surface's centroid above the origin, m

    /// Centre and radius of a sphere around the surface, body frame, scaled.
    Vec3f centre() const;
    float radius() const;
};

/// What of the surface is wet (section 6.2) and the hydrostatic force on it (Eqs. 1, 4 and 5), by an exact clip of
/// every triangle against the surface, taken as flat within the triangle.
void measure_wet_surface(Body& body, const SurfaceView& surface, const Fluid& fluid);

/// Lays the volume that the body displaces under the calm surface, `level` above its origin, into its footprint; with
/// `spread`, the wider the deeper. After measure_wet_surface, which turns the surface.
void lay_displacement(Body& body, float level, bool spread);

/// Eq. 6 for every source, and the pressure of the upper sources laid into the footprint (section 6.3). `model` says by
/// its bits: own_waves, that the water's velocity is taken without what the body itself made; displacement, that the
/// pressure reaches the surface the wider the deeper its source is; fluctuation, speeds and spin, what of the map is
/// used beyond the paper's. `skip`: what is left out where it does not count (core/skip.h).
void look_up_resistance(Body& body, const SurfaceView& surface, const Fluid& fluid, float dt, std::uint32_t model,
                        std::uint32_t skip);

/// Source `l` as the last tick found it; nothing but its position where it was dry.
SourceReading read_source(const Body& body, std::uint32_t l);

/// Weight, and the sum of the parts (Eq. 4).
void sum_forces(Body& body, const Fluid& fluid);

}  // namespace frm
