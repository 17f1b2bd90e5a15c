// Writes down what a world is told and what it answers: handed over without waiting, written by a thread of its own (where
// there are no threads, at once).
#pragma once

#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "core/api/objects.h"
#include "device/event_queue.h"
#include "device/recording.h"

namespace frm::device {

class Device;

struct RecorderDef {
    std::uint32_t hash_interval = 100;  ///< ticks
    std::uint32_t force_interval = 1;   ///< ticks; exchanges
    std::uint32_t queue_bytes = 1 << 22;
    bool waits = false;  ///< for the writer, where it has no room; else what has none is lost, and counted
};

class Recorder : public api::Object, public WorldObserver {
public:
    Recorder(api::WorldObject& world, const char* path, const RecorderDef& def, std::uint32_t axes);
    ~Recorder() override;

    const api::WorldObject& world() const { return world_; }
    void add_device(Device& device);
    void forget(Device& device);
    /// Throws Error: FRM_ERROR_FILE if anything could not be written, FRM_ERROR_CAPACITY if anything was lost.
    void close();
    frm_recorder_stats stats() const;

    /// With the packet that the device's driver gives for it.
    void exchanged(Device& device, const frm_device_command& command, const frm_device_state& state);

    void water_created(const World& world) override;
    void water_destroyed(const World& world) override;
    void height_set(const World& world, const float* height, std::size_t count) override;
    void pressure_set(const World& world, const float* pressure, std::size_t count) override;
    void body_created(const World& world, const Body& body) override;
    void body_destroyed(const World& world, std::uint32_t id) override;
    void motion_set(const World& world, const Body& body) override;
    void ticked(const World& world, float dt) override;

private:
    // What goes through the queue as it is in memory.
    struct ExchangeHead {
        std::uint32_t device, has_wrenches;
        frm_wrench command;
        frm_device_state state;
    };
    struct MotionBytes {
        std::uint32_t id;
        Pose pose;
        Twist twist;
    };
    struct TickHead {
        std::uint64_t tick, hash;
        double time;
        float dt;
        std::uint32_t bodies, has_hash, has_forces;
    };

    template <typename Fill>
    void put(EventType type, std::size_t size, Fill&& fill);
    /// For events that come seldom, from calls that may take their time.
    void put(Event&& event);
    bool has_room_again();
    void lose();
    void work();
    void take_all();
    void take(std::uint32_t type, const std::uint8_t* data, std::size_t size);
    void detach();
    std::uint32_t number_of(const std::shared_ptr<const Map>& map);

    api::WorldObject& world_;
    RecordingWriter writer_;  ///< the thread's, while it runs
    RecorderDef def_;
    EventQueue queue_;
    std::atomic<std::uint64_t> lost_{0}, lost_since_{0}, bytes_{0}, ticks_{0};
    std::exception_ptr failure_;  ///< of the writing
    std::mutex lock_;
    std::condition_variable wake_;
    bool closing_ = false;
    std::thread thread_;
    Event taken_;
    std::vector<std::shared_ptr<const Map>> maps_;
    std::vector<Device*> devices_;
    bool attached_ = false;
};

}  // namespace frm::device

template <>
struct frm::api::KindOf<frm::device::Recorder> {
    static constexpr Kind kind = Kind::recorder;
};
