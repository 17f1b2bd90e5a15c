#include "core/world/world.h"

#include <algorithm>
#include <cmath>

#include "core/water/coupling.h"

namespace frm {
namespace {

/// Of the stable step, and s: what water may wait for. With longer waits forces are further off than the rule's bound
/// (docs/model.md, section 7); a picture of the water must not stutter.
constexpr float longest_wait = 0.25f, longest_wait_time = 5e-3f;

bool finite(const Forces& f) {
    const Vec3f sum = f.total.force + f.total.torque;  // of parts: one that is not finite shows
    return std::isfinite(sum.x) && std::isfinite(sum.y) && std::isfinite(sum.z);
}

/// No point of the body is lower, m.
double lowest(const Body& body) {
    return body.def.pose.position.z + static_cast<double>(dot(body.rotation.row2, body.centre()) - body.radius());
}

void forget_forces(Body& body) {
    body.forces = {};
    body.displaced_volume = body.wet_area = body.relative_speed = 0;
    body.wet_sources = body.clipped_triangles = 0;
    body.by_one_evaluation = false;
    for (SourceState& source : body.sources) source = {};
    body.wetness = Wetness::unknown;
    body.streams.forget();
    body.map_time_owed = 0;
}

}  // namespace

World::World(const WorldDef& def, std::uint32_t threads, std::pmr::memory_resource* memory)
    : def_(def), threads_(threads), memory_(memory), bodies_(memory), pushes_(memory) {
    pushes_.reserve(2);
}

Water& World::create_water(const WaterDef& def) {
    WaterDef with = def;
    with.field.skip_calm_tiles &= (def_.skip & skip_calm_water) != 0;
    water_ = std::allocate_shared<Water>(std::pmr::polymorphic_allocator<Water>(memory_), with, memory_);
    clock_.restart();
    try {
        for (const auto& body : bodies_) give_footprint(*body);
        if (observer_) observer_->water_created(*this);
        water_->offer_snapshot(ticks_, time_);
    } catch (...) {
        for (const auto& body : bodies_) take_footprint(*body);
        water_.reset();
        throw;
    }
    return *water_;
}

void World::destroy_water() {
    for (const auto& body : bodies_) take_footprint(*body);
    water_.reset();
    if (observer_) observer_->water_destroyed(*this);
}

void World::set_height(const float* height) {
    water_->set_height(height);
    for (const auto& body : bodies_) {
        body->footprint->count_as_given();
        body->footprint->own.calm();
        body->account->clear();
    }
    clock_.restart();
    stepped_at_ = ticks_;
    water_->offer_snapshot(ticks_, time_);
    if (observer_) observer_->height_set(*this, height, water_->field.cells());
}

void World::set_pressure(const float* pressure) {
    water_->set_pressure(pressure, clock_.behind());
    if (observer_) observer_->pressure_set(*this, pressure, pressure ? water_->field.cells() : 0);
}

Body& World::create_body(const BodyDef& def, std::uint32_t id) {
    pushes_.reserve(bodies_.size() + 3);
    auto body = std::allocate_shared<Body>(std::pmr::polymorphic_allocator<Body>(memory_), def, id, memory_);
    if (water_) give_footprint(*body);
    bodies_.push_back(std::move(body));
    try {
        if (observer_) observer_->body_created(*this, *bodies_.back());
    } catch (...) {
        bodies_.pop_back();
        throw;
    }
    next_body_ = id + 1;
    return *bodies_.back();
}

void World::give_footprint(Body& body) {
    body.stays_dry = false;
    const float cell = water_->def().field.cell, scale = body.def.scale;
    const double volume = body.def.map->shape.volume * static_cast<double>(scale * scale * scale);
    body.footprint.emplace(water_->def().field, body.radius(), volume, memory_);
    body.elements.emplace(*body.def.map, cell / scale, body.footprint->levels(), memory_);
    body.account.emplace(*body.elements, body.footprint->levels(), memory_);
}

void World::take_footprint(Body& body) {
    body.account.reset();
    body.elements.reset();
    body.footprint.reset();
}

void World::destroy_body(Body& body) {
    if (body.footprint && def_.model & model_displacement) withdraw_body(*body.footprint, water_->field);
    const std::uint32_t id = body.id;
    bodies_.erase(std::find_if(bodies_.begin(), bodies_.end(), [&](const auto& b) { return b.get() == &body; }));
    if (observer_) observer_->body_destroyed(*this, id);
}

void World::set_motion(Body& body, const Pose& pose, const Twist& twist) {
    body.def.pose = pose;
    body.def.twist = twist;
    body.rotation = Rotation<float>(pose.rotation);
    if (observer_) observer_->motion_set(*this, body);
}

// What a body displaces raises a basin's level as far as the body is over the basin and not beside it.
float World::share_over_water(const Body& body, const GridOrigin& centre) const {
    const FieldDef& field = water_->def().field;
    const float reach = body.radius() / field.cell;
    const auto along = [&](std::int32_t whole, float rest, std::int32_t cells) {
        const float at = static_cast<float>(whole) + rest, low = std::max(at - reach, 0.0f),
                    high = std::min(at + reach, static_cast<float>(cells));
        return std::clamp((high - low) / (2 * reach), 0.0f, 1.0f);
    };
    return along(centre.i, centre.x, field.nx) * along(centre.j, centre.y, field.ny);
}

bool World::rests_around(const Body& body, const SurfaceView& view) const {
    const Vec3f centre = body.rotation.to_world(body.centre()) * view.cells_per_metre;
    const auto reach = static_cast<std::int32_t>(std::min(body.radius() * view.cells_per_metre, 1e6f)) + 2;
    const std::int32_t i = view.origin.i + static_cast<std::int32_t>(view.origin.x + std::clamp(centre.x, -1e6f, 1e6f)),
                       j = view.origin.j + static_cast<std::int32_t>(view.origin.y + std::clamp(centre.y, -1e6f, 1e6f));
    return water_->field.rests({i - reach, j - reach, i + reach, j + reach});
}

SurfaceView World::view_from(const Body& body, float dt, const WaveTime& waves) const {
    SurfaceView view;
    view.everywhere = def_.everywhere;
    view.level = static_cast<float>(def_.level - body.def.pose.position.z);
    if (water_) {
        const FieldDef& field = water_->def().field;
        const float behind = clock_.behind(), last_step = clock_.last_step();
        // Of equal steps those of a tick begin before it and end before its end: bodies feel the water as late as if they
        // did not.
        const bool equal = waves.equal > 0;
        const float ahead = equal ? behind + 0.5f * std::max(dt - waves.step, 0.0f) : behind;
        view.field = &water_->field;
        view.origin = body.footprint->body();
        view.cells_per_metre = 1.0f / field.cell;
        view.fastest = std::sqrt(def_.fluid.gravity * field.depth);
        view.waits = waves.steps == 0;
        view.ahead = ahead;
        view.rise = ahead * field.depth / field.cell;
        view.bend = 0.5f * ahead * (ahead + last_step) * def_.fluid.gravity * field.depth / (field.cell * field.cell);
        // What the body lays now is in all steps of this tick, each of which pushes the water by it; so it feels the mean
        // of the heights that those steps begin with, and body and water push each other alike.
        if (waves.steps > 1) {
            const auto count = static_cast<float>(waves.steps);
            const float time = waves.time;
            float mean = 0.5f * time * (count - 1) / count,
                  square = time * time * (count - 1) * (2 * count - 1) / (6 * count * count);
            if (equal) {
                const float later = std::clamp(ahead - mean, 0.0f, waves.step);
                view.later = later / waves.step;
                square += later * (2 * mean + later);
                mean += later;
            }
            view.ahead = mean;
            view.rise = mean * field.depth / field.cell;
            view.bend =
                0.5f * (square + mean * time / count) * def_.fluid.gravity * field.depth / (field.cell * field.cell);
            view.steps = waves.steps;
            view.step = time / count;
            view.gravity = def_.fluid.gravity;
            view.room = &water_->room();
        }
        // The field's velocities are half a step older than its heights; where no tick waits, half a tick.
        const float older = behind + 0.5f * (equal ? std::max(last_step - dt, 0.0f) : last_step - dt);
        view.pull = std::max(0.0f, older) * def_.fluid.gravity / field.cell;
        view.scratch = water_->scratch();
        view.still = has_budget() && rests_around(body, view);
    }
    return view;
}

// Over water a body is dry where it hangs higher than the water is deep, unless a wave is known to be as high.
bool World::cannot_be_wet(const Body& body) const {
    if (def_.everywhere) return false;
    const double low = lowest(body) - def_.level;
    if (!water_) return low > 0;
    return low > static_cast<double>(water_->def().field.depth) && !water_->field.has_high_waves();
}

WaveTime World::time_waves(float dt) const {
    if (!water_) return {};
    const bool displaces = (def_.model & model_displacement) != 0;
    // Where the velocity is forced in each step, a step leaves u = U - dt g dh/dx, and heights diffuse with g d dt:
    // stable for a Courant number up to 1/2 only, and not 1 / sqrt(2).
    const float courant = displaces ? 1.0f : 0.70710678f;
    const float stable = courant * Field::stable_step(water_->def().field, def_.fluid.gravity);
    return clock_.plan(dt, {stable, std::min(longest_wait * stable, longest_wait_time),
                            (def_.skip & skip_wave_steps) != 0 && displaces});
}

// A body's volume is in the water before any body feels the water, so that what a body feels of its own displacement is that
// of its present pose. A tick late it would be a spring that pulls by where the body was, k (z - dt v) instead of k z: it
// drives the body by k dt v. With it in time, a host's v += dt F / m, x += dt v is one symplectic step of body and water.
void World::place_body(Body& body, float dt, const WaveTime& waves) {
    // What was dry without a wave of its own stays so: its forces are as they were, but for its weight.
    const bool settled = body.wetness == Wetness::dry &&
                         (body.stays_dry || !body.footprint || (!body.footprint->first && !body.footprint->active()));
    body.stays_dry = settled && def_.skip & skip_dry_bodies && cannot_be_wet(body);
    if (!body.footprint || body.stays_dry) return;
    const bool spread = (def_.model & model_displacement) != 0;
    const auto level = static_cast<float>(def_.level - body.def.pose.position.z);
    const Vec3f centre = body.rotation.to_world(body.centre());
    const GridOrigin at = water_->origin_at(body.def.pose.position.x + static_cast<double>(centre.x),
                                            body.def.pose.position.y + static_cast<double>(centre.y));
    // A body whose window lies wholly beside the water is as one too deep to be seen there.
    const std::int32_t reach = body.footprint->size();
    const Rect near{at.i - reach, at.j - reach, at.i + reach, at.j + reach};
    const bool deep = spread && def_.skip & skip_deep_bodies &&
                      (near.clipped(water_->field.def().nx, water_->field.def().ny).empty() ||
                       body.footprint->is_deep(level - dot(body.rotation.row2, body.centre()) - body.radius()));
    const GridOrigin origin = water_->origin_at(body.def.pose.position.x, body.def.pose.position.y);
    body.footprint->begin(at.i, at.j, origin, spread ? &water_->field : nullptr);
    body.pushes = !deep;
    if (deep)
        leave_displacement(body);
    else
        lay_displacement(body, level, spread, (def_.skip & skip_still_bodies) != 0);
    body.footprint->keep_over_water(share_over_water(body, at));
    if (spread) {
        const float behind = clock_.behind();
        if (!deep)
            charge_displacement(body, water_->field, origin, level, def_.fluid.density * def_.fluid.gravity, dt,
                                0.5f * waves.time / static_cast<float>(std::max(1u, waves.steps)) - behind,
                                water_->scratch());
        // It was displaced in the middle of this tick, on average; a step takes it for displaced half of itself before.
        const float late = behind + 0.5f * std::max(waves.step - dt, 0.0f);
        displace_water(*body.footprint, water_->field, late * def_.fluid.gravity);
    }
    skipped_.still_bodies += body.footprint->kept();
    skipped_.deep_bodies += deep;
}

void World::tick_body(Body& body, float dt, float time_budget, const WaveTime& waves) {
    if (body.stays_dry) {
        ++skipped_.dry_bodies;
        body.streams.rotation = body.rotation;
        sum_forces(body, def_.fluid);
        return;
    }
    const SurfaceView view = view_from(body, dt, waves);
    measure_wet_surface(body, view, def_.fluid, def_.skip);
    body.budget = {def_.error_budget, time_budget};
    look_up_resistance(body, view, def_.fluid, dt, def_.model, def_.skip);
    if (body.account && def_.model & model_displacement) body.account->drag_work += work_of_drag(body, dt);
    skipped_.whole_bodies += body.by_one_evaluation;
    skipped_.coarse_bodies += body.detail.groups > 0;
    skipped_.over_budget_bodies += body.detail.over_budget;
    sum_forces(body, def_.fluid);
}

bool World::tick(float dt) {
    const WaveTime waves = time_waves(dt);
    const bool waits = water_ && waves.steps == 0;
    float time_each = 0;
    if (def_.time_budget > 0) {
        std::uint32_t wet = 0;  // in the last tick, or it may be in this one
        for (const auto& body : bodies_) wet += body->wet_sources > 0 || def_.everywhere || lowest(*body) < def_.level;
        time_each = def_.time_budget / static_cast<float>(std::max(1u, wet));
    }

    bool diverged = false;
    const std::uint64_t waited = skipped_.water_waits + waits;
    skipped_ = {};
    skipped_.water_waits = waited;
    for (const auto& body : bodies_) place_body(*body, dt, waves);
    for (const auto& body : bodies_) {
        tick_body(*body, dt, time_each, waves);
        if (!body->water_finite || !finite(body->forces)) {
            forget_forces(*body);
            diverged = true;
        }
    }
    if (water_) {
        clock_.advance(dt, waves);
        move_water(waves);
        diverged = diverged || !water_->field.is_finite();
    }
    if (diverged && water_) calm_water();

    ++ticks_;
    time_ += static_cast<double>(dt);
    // A copy of the water is made while it waits, if it ever does: not in the tick that steps it.
    const bool offers = waits || substeps_ > 0 || ticks_ == 1;
    substeps_ = waves.steps;
    if (!waits) stepped_at_ = ticks_;
    if (water_ && offers) water_->offer_snapshot(stepped_at_, time_ - static_cast<double>(clock_.behind()));
    if (observer_) observer_->ticked(*this, dt);
    return !diverged;
}

void World::calm_water() {
    water_->field.calm();
    for (const auto& body : bodies_) {
        body->footprint->own.calm();
        body->account->clear();
    }
}

void World::move_water(const WaveTime& waves) {
    if (waves.steps > 0) step_waves(waves);
    for (const auto& body : bodies_) {
        if (body->stays_dry) continue;  // nothing was begun
        body->footprint->end();
        // Whose own waves have gone has none left to give back.
        if (!body->footprint->active()) body->account->credit = std::max(body->account->credit, 0.0);
    }
}

void World::step_waves(const WaveTime& waves) {
    Field& field = water_->field;
    const bool displaces = (def_.model & model_displacement) != 0, own_waves = (def_.model & model_own_waves) != 0;
    const float step = waves.time / static_cast<float>(waves.steps), push = step / def_.fluid.density;
    const float gravity = def_.fluid.gravity, most = def_.fluid.density * gravity * field.def().depth;
    if (water_->take_start()) field.start_from_rest(step, gravity);
    pushes_.clear();
    const Rect all{0, 0, field.def().nx, field.def().ny};
    if (water_->pressure()) pushes_.push_back({water_->pressure(), all.i1, all.j1, all, 0, 0, push});
    if (const float* owed = water_->owed_pressure())
        pushes_.push_back({owed, all.i1, all.j1, all, 0, 0, push / waves.time});
    for (const auto& body : bodies_) {
        if (body->stays_dry) continue;
        body->footprint->gather_pressure(most);
        // The paper's rule takes Eq. 10 as it is.
        const float share = displaces ? share_of_push(*body, field, def_.fluid, waves.time, waves.steps) : 1.0f;
        if (body->footprint->pressed().empty()) continue;
        body->footprint->push = push * share;
        pushes_.push_back(push_on_water(*body->footprint));
    }
    // Where the velocity inside a body is forced, that is before each step.
    for (std::uint32_t n = 0; n < (displaces ? 1 : waves.steps); ++n) {
        const std::uint32_t steps = displaces ? waves.steps : 1;
        if (!displaces)
            for (const auto& body : bodies_)
                force_velocity(*body->footprint, field, body->def.twist.linear, body->def.twist.angular,
                               body->wet_height);
        field.advance(step, gravity, steps, pushes_.data(), pushes_.size(), threads_);
        if (!own_waves) continue;
        for (const auto& body : bodies_) advance_own(*body->footprint, step, gravity, steps);
    }
    water_->pay_pressure();
}

}  // namespace frm
