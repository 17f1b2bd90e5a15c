// One rigid body in a world: its motion, what of it is wet, and the forces of the last tick.
#pragma once

#include <cstdint>
#include <memory>
#include <memory_resource>
#include <optional>
#include <vector>

#include "core/body/source_streams.h"
#include "core/body/volume_elements.h"
#include "core/body/wave_account.h"
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
};

/// How exact, or how fast, a body's resistance is to be.
struct Budget {
    /// N: the force may be off by so much (its torque by that times the distance of the furthest source). Where that
    /// suffices, groups of sources are looked up as one. 0: every source by itself.
    float error = 0;
    /// us: what the lookups may cost, counted by a fixed price each and not by the clock, which would not give the same
    /// bits twice. 0: no limit. Goes before `error`.
    float time = 0;
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

enum class Wetness : std::uint8_t { unknown, dry, partly, whole };

struct Body {
    Body(const BodyDef& def, std::uint32_t id, std::pmr::memory_resource* memory);

    // What a tick looks at of a body far from the water lies together: of a thousand it waits for the cache.
    BodyDef def;
    std::uint32_t id;          ///< counts the bodies of a world in the order of creation
    bool stays_dry = false;    ///< nothing of it is looked at in this tick but its weight (FRM_SKIP_DRY_BODIES)
    bool pushes = true;        ///< it is near enough to the surface to push it
    bool water_finite = true;  ///< the surface around it is a finite number
    Wetness wetness = Wetness::unknown;  ///< what the sources and the buoyancy were last set to
    Rotation<float> rotation;
    Forces forces;

    SourceStreams streams;  ///< of the last tick
    std::pmr::vector<SourceState> sources;
    std::optional<Footprint> footprint;      ///< while the world has water
    std::optional<VolumeElements> elements;  ///< while it has a footprint: what is laid into it
    std::optional<WaveAccount> account;      ///< while it has a footprint: of the energy that goes by it

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
        bool over_budget = false;  ///< it costs more than the time budget, or is further off than the error budget
    } detail;
    float map_time_owed = 0;  ///< s, to all wet sources, of ticks that looked up groups
    Budget budget;            ///< of this tick
    float wet_height = 0;  ///< of the wet surface's centroid above the origin, m, as if the surface over it were calm
    bool by_one_evaluation = false;  ///< the wet surface of the last tick

    Vec3d laid_at;  ///< the pose that the footprint's thickness belongs to
    Rotation<float> laid_rotation;

    bool all_wet() const { return wetness == Wetness::whole; }
    /// Centre and radius of a sphere around the surface, body frame, scaled.
    Vec3f centre() const;
    float radius() const;
};

/// Where the centre of the body's box lies over water whose cell `origin` the body's origin is in.
GridPlacement placement(const Body& body, const GridOrigin& origin, float cells_per_metre);

/// What of the surface is wet (section 6.2) and the hydrostatic force on it (Eqs. 1, 4 and 5). The water is a plane over
/// each cluster of triangles: clusters that it leaves wholly wet or dry take one evaluation, the triangles of the others
/// an exact clip. Under a calm surface a body that is wholly wet or dry takes one evaluation itself.
void measure_wet_surface(Body& body, const SurfaceView& surface, const Fluid& fluid, std::uint32_t skip = skip_default);

/// Lays the volume that the body displaces under the calm surface, `level` above its origin, into its footprint; with
/// `spread`, the wider the deeper. `keep_still`: a body of which no point has moved by a thousandth of a cell since keeps
/// what was laid; its volume under the surface is off by less than that times the area of its waterline.
void lay_displacement(Body& body, float level, bool spread, bool keep_still = true);

/// What that changes in `water` beyond what the body pays for it goes to the body's account (WaveAccount::charge), for a
/// fluid that weighs `weight`, N/m^3. After lay_displacement, and before the water has it.
void charge_displacement(Body& body, const Field& water, const GridOrigin& origin, float level, float weight, float dt,
                         float half_step, float* scratch);

/// J that the body's drag does on the water in a tick, by its last forces.
double work_of_drag(const Body& body, float dt);

/// Of a body's push, in `steps` wave steps of `time` in all, the share that the water takes. A push follows from the velocity
/// that the water has, so that a body would else drive the waves it meets, one at rest too: it gives no more energy than the
/// body's drag did work since the last step, nor than the body's account has. What the account lacks, the water around the body
/// gives back.
float share_of_push(Body& body, Field& water, const Fluid& fluid, float time, std::uint32_t steps);

/// Instead: all of the body's volume counts as even over all of the water (FRM_SKIP_DEEP_BODIES).
void leave_displacement(Body& body);

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
