#include "device/recorder.h"

#include <algorithm>

#include "core/error.h"
#include "core/map/codec.h"
#include "device/device.h"

namespace frm::device {

Recorder::Recorder(api::WorldObject& world, const char* path, std::uint32_t hash_interval, std::uint32_t axes)
    : world_(world), writer_(path), hash_interval_(hash_interval) {
    const World& w = world.world;
    writer_.write(event::World{w.def(), hash_interval, axes});
    if (const Water* water = w.water()) {
        water_created(w);
        // Only heights that were set: told of calm ones, a replay's tiles would be awake that were not.
        if (water->starts()) {
            std::vector<float> height(water->field.cells());
            water->field.copy_heights(height.data());
            height_set(w, height.data(), height.size());
        }
        if (water->pressure()) pressure_set(w, water->pressure(), water->field.cells());
    }
    for (const auto& body : w.bodies()) body_created(w, *body);
    writer_.flush();
    world_.world.observe(this);
    ++world_.users;
    attached_ = true;
}

Recorder::~Recorder() {
    try {
        close();
    } catch (...) {
        // Whoever wants to know closes the recorder; what could be written is in the .part file.
    }
}

void Recorder::detach() {
    if (!attached_) return;
    attached_ = false;
    world_.world.observe(nullptr);
    --world_.users;
    for (Device* device : devices_)
        if (device) device->recorder = nullptr;
}

void Recorder::close() {
    if (!attached_) return;
    detach();
    writer_.write(event::End{world_.world.ticks()});
    writer_.close();
}

void Recorder::add_device(Device& device) {
    if (devices_.size() == 16) throw Error(FRM_ERROR_LIMIT, "a recorder takes 16 devices");
    if (device.recorder) throw Error(FRM_ERROR_STATE, "this device is recorded already");
    const frm_device_info info = device.info();
    writer_.write(event::Device{info.serial, info.max_force, info.max_torque, info.name});
    device.recorder = this;
    device.recorded_as = static_cast<std::uint32_t>(devices_.size());
    devices_.push_back(&device);
}

void Recorder::forget(Device& device) {
    std::replace(devices_.begin(), devices_.end(), &device, static_cast<Device*>(nullptr));
}

void Recorder::exchanged(std::uint32_t device, const frm_device_command& command, const frm_device_state& state) {
    writer_.write(event::Exchange{device, command.wrench, state});
}

void Recorder::water_created(const World& world) { writer_.write(event::Water{world.water()->def()}); }

void Recorder::water_destroyed(const World&) { writer_.write(event::WaterEnd{}); }

void Recorder::height_set(const World&, const float* height, std::size_t count) {
    writer_.write(event::Height{{height, height + count}});
}

void Recorder::pressure_set(const World&, const float* pressure, std::size_t count) {
    writer_.write(event::Pressure{{pressure, pressure + count}});
}

std::uint32_t Recorder::number_of(const std::shared_ptr<const Map>& map) {
    const auto found = std::find(maps_.begin(), maps_.end(), map);
    if (found != maps_.end()) return static_cast<std::uint32_t>(found - maps_.begin());
    event::Map e;
    e.file.assign(map->file.begin(), map->file.end());
    writer_.write(e);
    maps_.push_back(map);
    return static_cast<std::uint32_t>(maps_.size() - 1);
}

void Recorder::body_created(const World&, const Body& body) {
    const std::uint32_t map = number_of(body.def.map);
    writer_.write(event::Body{body.id, map, body.def});
}

void Recorder::body_destroyed(const World&, std::uint32_t id) { writer_.write(event::BodyEnd{id}); }

void Recorder::motion_set(const World&, const Body& body) {
    writer_.write(event::Motion{body.id, body.def.pose, body.def.twist});
}

void Recorder::ticked(const World& world, float dt) {
    tick_.dt = dt;
    tick_.forces.clear();
    for (const auto& body : world.bodies()) tick_.forces.push_back(body->forces);
    tick_.has_hash = world.ticks() % hash_interval_ == 0;
    if (tick_.has_hash) tick_.hash = world.hash();
    writer_.write(tick_);
}

}  // namespace frm::device
