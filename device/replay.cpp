#include "device/replay.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"

namespace frm::device {
namespace {

constexpr std::uint32_t most_bodies_ever = 1'000'000;

bool same_bits(const Wrench& a, const Wrench& b) { return std::memcmp(&a, &b, sizeof a) == 0; }

/// The component that is furthest off; where all are as near as a zero's sign, the first whose bits differ.
void show(const frm_wrench& then, const frm_wrench& now, frm_replay_step_result& result) {
    const float was[6] = {then.force.x, then.force.y, then.force.z, then.torque.x, then.torque.y, then.torque.z};
    const float is[6] = {now.force.x, now.force.y, now.force.z, now.torque.x, now.torque.y, now.torque.z};
    float most = -1;
    for (std::uint32_t i = 0; i < 6; ++i) {
        const float off = std::abs(is[i] - was[i]);
        if (std::memcmp(&is[i], &was[i], 4) == 0 || off <= most) continue;
        most = off;
        result.component = i;
        result.recorded = was[i];
        result.replayed = is[i];
    }
}

}  // namespace

Replay::Replay(api::Context& context, const char* path) : context_(context), reader_(path) {
    survey();
    reader_.rewind();
    try {
        advance_to_tick();
        if (!world_)
            throw Error(FRM_ERROR_CORRUPT, "%s: holds no world%s", path,
                        info_.torn ? ": it was cut off inside its first block" : "");
    } catch (...) {
        release();
        throw;
    }
}

Replay::~Replay() { release(); }

void Replay::release() {
    if (world_) context_.remove(world_->handle);
    world_.reset();
    for (const ReplayedMap& map : maps_) context_.remove(map.handle);
    maps_.clear();
}

// A caller finds the world as it was just before the next tick: water, bodies and maps are there to look at before the
// first step.
void Replay::advance_to_tick() {
    Event e;
    has_tick_ = false;
    while (!has_tick_ && !gap_ && reader_.next(e)) std::visit([&](const auto& what) { apply(what); }, e);
}

void Replay::survey() {
    info_.struct_size = sizeof info_;
    Event e;
    std::vector<std::uint32_t> there;  // bodies, in order of creation
    while (info_.lost_events == 0 && reader_.next(e)) {
        if (const auto* tick = std::get_if<event::Tick>(&e)) {
            ++info_.ticks;
            info_.time += static_cast<double>(tick->dt);
            for (std::size_t i = 0; i < std::min(there.size(), tick->forces.size()); ++i) {
                Peak& peak = peaks_[there[i]];
                const Wrench& total = tick->forces[i].total;
                peak.force = std::max(peak.force, length(total.force));
                peak.torque = std::max(peak.torque, length(total.torque));
            }
        }
        if (const auto* body = std::get_if<event::Body>(&e)) {
            if (body->id > most_bodies_ever)
                throw Error(FRM_ERROR_CORRUPT, "recording: body %u does not follow", body->id);
            there.push_back(body->id);
            peaks_.resize(std::max<std::size_t>(peaks_.size(), body->id + 1));
        }
        if (const auto* end = std::get_if<event::BodyEnd>(&e))
            there.erase(std::remove(there.begin(), there.end(), end->id), there.end());
        if (const auto* gap = std::get_if<event::Gap>(&e)) info_.lost_events = std::max<std::uint64_t>(1, gap->events);
        info_.bodies += std::holds_alternative<event::Body>(e);
        info_.devices += std::holds_alternative<event::Device>(e);
        info_.maps += std::holds_alternative<event::Map>(e);
        if (std::holds_alternative<event::Water>(e)) info_.has_water = 1;
    }
    if (info_.lost_events > 0)
        context_.log(FRM_LOG_WARNING,
                     "the recording has a gap after %llu ticks: %llu events were lost when it was made",
                     static_cast<unsigned long long>(info_.ticks), static_cast<unsigned long long>(info_.lost_events));
    info_.torn = reader_.torn();
    if (info_.torn)
        context_.log(FRM_LOG_WARNING, "the recording was cut off after %llu ticks",
                     static_cast<unsigned long long>(info_.ticks));
}

World& Replay::the_world() {
    if (!world_) throw Error(FRM_ERROR_CORRUPT, "recording: something happens before there is a world");
    return world_->world;
}

Replay::ReplayedBody& Replay::the_body(std::uint32_t id) {
    if (id >= bodies_.size() || !bodies_[id].body)
        throw Error(FRM_ERROR_CORRUPT, "recording: body %u is not there", id);
    return bodies_[id];
}

void Replay::apply(const event::World& e) {
    if (world_) throw Error(FRM_ERROR_CORRUPT, "recording: a second world");
    world_ = context_.make<api::WorldObject>(e.def, context_.threads(), context_.memory());
    world_->replayed = true;
    api::add_world(context_, world_);
}

void Replay::apply(const event::Map& e) {
    auto map = api::read_map(context_, e.file.data(), e.file.size());
    const std::uint64_t handle = context_.add(api::Kind::map, context_.make<api::MapObject>(map));
    maps_.push_back({std::move(map), handle});
}

void Replay::apply(const event::Water& e) {
    if (the_world().water()) throw Error(FRM_ERROR_CORRUPT, "recording: a second water");
    the_world().create_water(e.def);
    water_ = api::add_water(context_, *world_);
}

void Replay::apply(const event::WaterEnd&) {
    if (!the_world().water()) throw Error(FRM_ERROR_CORRUPT, "recording: there is no water to take away");
    context_.remove(water_);
    water_ = 0;
    the_world().destroy_water();
}

void Replay::apply(const event::Height& e) {
    const Water* water = the_world().water();
    if (!water || e.values.size() != water->field.cells())
        throw Error(FRM_ERROR_CORRUPT, "recording: heights do not fit the water");
    the_world().set_height(e.values.data());
}

void Replay::apply(const event::Pressure& e) {
    const Water* water = the_world().water();
    if (!water || (!e.values.empty() && e.values.size() != water->field.cells()))
        throw Error(FRM_ERROR_CORRUPT, "recording: pressures do not fit the water");
    the_world().set_pressure(e.values.empty() ? nullptr : e.values.data());
}

void Replay::apply(const event::Body& e) {
    // A recorder may begin when earlier bodies are gone: numbers grow, but need not follow on.
    if (e.map >= maps_.size() || e.id < bodies_.size() || e.id > most_bodies_ever)
        throw Error(FRM_ERROR_CORRUPT, "recording: body %u does not follow", e.id);
    BodyDef def = e.def;
    def.map = maps_[e.map].map;
    bodies_.resize(e.id + 1);
    Body& body = the_world().create_body(def, e.id);
    bodies_[e.id] = {&body, api::add_body(context_, *world_, body)};
}

void Replay::apply(const event::BodyEnd& e) {
    ReplayedBody& body = the_body(e.id);
    context_.remove(body.handle);
    the_world().destroy_body(*body.body);
    body = {};
}

void Replay::apply(const event::Motion& e) { the_world().set_motion(*the_body(e.id).body, e.pose, e.twist); }

bool Replay::differs(std::uint32_t body, const Wrench& now, const Wrench& then) const {
    if (same_bits(now, then)) return false;
    const frm_replay_tolerance& t = tolerance_;
    if (!(t.relative > 0 || t.force > 0 || t.torque > 0)) return true;
    const Peak peak = body < peaks_.size() ? peaks_[body] : Peak{};
    return !(length(now.force - then.force) <= t.relative * peak.force + t.force &&
             length(now.torque - then.torque) <= t.relative * peak.torque + t.torque);
}

void Replay::compare(const event::Tick& e, frm_replay_step_result& result) const {
    const World& world = world_->world;
    const auto differ = [&](std::uint32_t body, frm_part part) {
        result.diverged = 1;
        result.body = body;
        result.part = part;
    };
    if (std::max(e.forces.size(), e.checks.size()) != world.bodies().size()) return differ(0, FRM_PART_WORLD);
    const bool exact = !(tolerance_.relative > 0 || tolerance_.force > 0 || tolerance_.torque > 0);
    for (std::size_t i = 0; exact && i < e.checks.size(); ++i) {
        const Body& body = *world.bodies()[i];
        const std::uint32_t off = checks_of(body.forces) ^ e.checks[i];
        constexpr frm_part parts[] = {FRM_PART_BUOYANCY, FRM_PART_PRESSURE, FRM_PART_FRICTION, FRM_PART_GRAVITY};
        for (int p = 0; p < 4; ++p)
            if (off >> (8 * p) & 0xFF) {
                differ(body.id, parts[p]);
                result.recorded = result.replayed = std::numeric_limits<float>::quiet_NaN();  // only that they differ
                return;
            }
    }
    for (std::size_t i = 0; i < e.forces.size(); ++i) {
        const Forces &now = world.bodies()[i]->forces, &then = e.forces[i];
        const std::uint32_t id = world.bodies()[i]->id;
        const struct {
            frm_part part;
            const Wrench &now, &then;
        } parts[] = {{FRM_PART_BUOYANCY, now.buoyancy, then.buoyancy},
                     {FRM_PART_PRESSURE, now.pressure, then.pressure},
                     {FRM_PART_FRICTION, now.friction, then.friction},
                     {FRM_PART_GRAVITY, now.gravity, then.gravity},
                     {FRM_PART_TOTAL, now.total, then.total}};
        for (const auto& p : parts) {
            if (!differs(id, p.now, p.then)) continue;
            differ(id, p.part);
            show(context_.axes().wrench_out(p.then), context_.axes().wrench_out(p.now), result);
            return;
        }
    }
    if (exact && e.has_hash && e.hash != world.hash()) differ(0, FRM_PART_WORLD);
}

frm_replay_step_result Replay::step() {
    // What follows a tick is applied with the next step, so that the answers to this one can be looked at.
    if (stepped_) advance_to_tick();
    stepped_ = false;
    if (!has_tick_) throw Error(FRM_ERROR_END, "the recording has no more ticks");
    if (!(next_tick_.dt >= 1e-6f && next_tick_.dt <= 0.1f))
        throw Error(FRM_ERROR_CORRUPT, "recording: a tick of %g s", static_cast<double>(next_tick_.dt));
    the_world().tick(next_tick_.dt);
    stepped_ = true;
    frm_replay_step_result result{};
    result.tick = world_->world.ticks();
    result.time = world_->world.time();
    compare(next_tick_, result);
    return result;
}

}  // namespace frm::device
