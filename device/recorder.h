// Writes down what a world is told and what it answers.
#pragma once

#include <memory>
#include <vector>

#include "core/api/objects.h"
#include "device/recording.h"

namespace frm::device {

class Device;

class Recorder : public api::Object, public WorldObserver {
public:
    Recorder(api::WorldObject& world, const char* path, std::uint32_t hash_interval, std::uint32_t axes);
    ~Recorder() override;

    const api::WorldObject& world() const { return world_; }
    void add_device(Device& device);
    void forget(Device& device);
    /// Throws Error (FRM_ERROR_FILE) if anything could not be written.
    void close();
    void exchanged(std::uint32_t device, const frm_device_command& command, const frm_device_state& state);

    void water_created(const World& world) override;
    void water_destroyed(const World& world) override;
    void height_set(const World& world, const float* height, std::size_t count) override;
    void pressure_set(const World& world, const float* pressure, std::size_t count) override;
    void body_created(const World& world, const Body& body) override;
    void body_destroyed(const World& world, std::uint32_t id) override;
    void motion_set(const World& world, const Body& body) override;
    void ticked(const World& world, float dt) override;

private:
    void detach();
    std::uint32_t number_of(const std::shared_ptr<const Map>& map);

    api::WorldObject& world_;
    RecordingWriter writer_;
    std::uint32_t hash_interval_;
    std::vector<std::shared_ptr<const Map>> maps_;
    std::vector<Device*> devices_;
    event::Tick tick_;
    bool attached_ = false;
};

}  // namespace frm::device

template <>
struct frm::api::KindOf<frm::device::Recorder> {
    static constexpr Kind kind = Kind::recorder;
};
