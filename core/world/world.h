// A world: a fluid, at most one water, bodies; and one tick in order.
#pragma once

#include <cstdint>
#include <memory>
#include <memory_resource>
#include <vector>

#include "core/body/body.h"
#include "core/skip.h"
#include "core/water/water.h"
#include "core/world/wave_clock.h"

namespace frm {

struct WorldDef {
    std::uint32_t model = model_default;
    bool everywhere = false;  ///< fluid without a surface
    double level = 0;         ///< of the calm surface, m
    Fluid fluid;
    std::uint32_t skip = skip_default;
    float error_budget = 0;  ///< N, of a body; 0: exact
    float time_budget = 0;   ///< us, of all bodies' resistance; 0: none
};

class World;

/// Is told of everything that changes a world, after it was done: how a recorder sees it.
class WorldObserver {
public:
    virtual ~WorldObserver() = default;
    virtual void water_created(const World& world) = 0;
    virtual void water_destroyed(const World& world) = 0;
    virtual void height_set(const World& world, const float* height, std::size_t count) = 0;
    virtual void pressure_set(const World& world, const float* pressure, std::size_t count) = 0;
    virtual void body_created(const World& world, const Body& body) = 0;
    virtual void body_destroyed(const World& world, std::uint32_t id) = 0;
    virtual void motion_set(const World& world, const Body& body) = 0;
    virtual void ticked(const World& world, float dt) = 0;
};

class World {
public:
    World(const WorldDef& def, std::uint32_t threads, std::pmr::memory_resource* memory);

    const WorldDef& def() const { return def_; }
    std::uint64_t ticks() const { return ticks_; }
    double time() const { return time_; }
    std::uint32_t substeps() const { return substeps_; }
    /// What the last tick left out (frm_world_stats), and water_waits since the beginning.
    struct Skipped {
        std::uint32_t dry_bodies = 0, whole_bodies = 0, still_bodies = 0, deep_bodies = 0, coarse_bodies = 0,
                      over_budget_bodies = 0;
        std::uint64_t water_waits = 0;
    };
    const Skipped& skipped() const { return skipped_; }
    /// How long ago the water was as its field is, s.
    float water_behind() const { return clock_.behind(); }
    /// ticks() when it became so.
    std::uint64_t water_stepped_at() const { return stepped_at_; }
    std::uint32_t bodies_created() const { return next_body_; }

    Water& create_water(const WaterDef& def);
    void destroy_water();
    Water* water() { return water_.get(); }
    const Water* water() const { return water_.get(); }
    void set_height(const float* height);
    void set_pressure(const float* pressure);

    Body& create_body(const BodyDef& def) { return create_body(def, next_body_); }
    /// With a number of its own, not below bodies_created(): how a replay keeps the recorded ones.
    Body& create_body(const BodyDef& def, std::uint32_t id);
    void destroy_body(Body& body);
    const std::pmr::vector<std::shared_ptr<Body>>& bodies() const { return bodies_; }
    void set_motion(Body& body, const Pose& pose, const Twist& twist);

    /// Throws Error (FRM_ERROR_LIMIT), with nothing changed, if the waves would need more than max_substeps steps. False
    /// if a force was not finite: that body's forces are zero then, and the water is calm.
    bool tick(float dt);
    static constexpr std::uint32_t max_substeps = WaveClock::max_substeps;

    std::uint64_t hash() const;
    void observe(WorldObserver* observer) { observer_ = observer; }
    WorldObserver* observer() const { return observer_; }

private:
    WaveTime time_waves(float dt) const;
    SurfaceView view_from(const Body& body, float dt, const WaveTime& waves) const;
    bool has_budget() const { return def_.error_budget > 0 || def_.time_budget > 0; }
    float share_over_water(const Body& body, const GridOrigin& centre) const;
    bool rests_around(const Body& body, const SurfaceView& view) const;
    bool cannot_be_wet(const Body& body) const;
    void place_body(Body& body, float dt, const WaveTime& waves);
    void tick_body(Body& body, float dt, float time_budget, const WaveTime& waves);
    void give_footprint(Body& body);
    static void take_footprint(Body& body);
    void move_water(const WaveTime& waves);
    void step_waves(const WaveTime& waves);
    void calm_water();

    WorldDef def_;
    std::uint32_t threads_;
    std::pmr::memory_resource* memory_;
    std::shared_ptr<Water> water_;
    std::pmr::vector<std::shared_ptr<Body>> bodies_;
    std::pmr::vector<Push> pushes_;  ///< of one tick; has room for all bodies
    WorldObserver* observer_ = nullptr;
    std::uint64_t ticks_ = 0, stepped_at_ = 0;
    double time_ = 0;
    WaveClock clock_;
    Skipped skipped_;
    std::uint32_t substeps_ = 0, next_body_ = 0;
};

}  // namespace frm
