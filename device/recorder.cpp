#include "device/recorder.h"

#include <algorithm>
#include <chrono>
#include <cstring>

#include "core/error.h"
#include "core/map/codec.h"
#include "device/device.h"
#include "device/start_thread.h"

namespace frm::device {
namespace {

/// How long the thread sleeps when there is nothing; nobody may wake it, which would be a call of the system.
constexpr auto nap = std::chrono::milliseconds(5);
/// An Event on the heap: its pointer is what the queue holds.
constexpr std::uint32_t whole_event = 64;

}  // namespace

Recorder::Recorder(api::WorldObject& world, const char* path, const RecorderDef& def, std::uint32_t axes)
    : world_(world), writer_(path), def_(def), queue_(def.queue_bytes) {
    const World& w = world.world;
    put(event::World{w.def(), def.hash_interval, axes});
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
    bytes_ = writer_.bytes();
    if (has_threads) thread_ = start_thread("a recorder", [this] { work(); });
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
    {
        const std::lock_guard<std::mutex> lock(lock_);
        closing_ = true;
    }
    wake_.notify_one();
    if (thread_.joinable()) thread_.join();
    if (failure_) std::rethrow_exception(failure_);
    if (const std::uint64_t lost = lost_since_.exchange(0)) writer_.write(event::Gap{lost});
    writer_.write(event::End{world_.world.ticks()});
    writer_.close();
    if (lost_ > 0)
        throw Error(FRM_ERROR_CAPACITY,
                    "%llu events were lost: the queue of %llu bytes was full (frm_recorder_def.queue_bytes); the "
                    "recording is good up to there",
                    static_cast<unsigned long long>(lost_.load()), static_cast<unsigned long long>(queue_.capacity()));
}

frm_recorder_stats Recorder::stats() const {
    frm_recorder_stats out{};
    out.ticks = ticks_;
    out.lost_events = lost_;
    out.file_bytes = bytes_;
    out.queue_bytes = queue_.capacity();
    out.queue_most = queue_.most_used();
    return out;
}

void Recorder::lose() {
    ++lost_;
    ++lost_since_;
}

// What was lost is said before what comes next.
bool Recorder::has_room_again() {
    if (lost_since_.load(std::memory_order_relaxed) == 0) return true;
    const std::uint64_t lost = lost_since_.exchange(0);
    if (lost == 0) return true;
    const bool good = queue_.put(static_cast<std::uint32_t>(EventType::gap), sizeof lost, [&](std::uint8_t* to) {
        std::memcpy(to, &lost, sizeof lost);
        return sizeof lost;
    });
    if (!good) lost_since_ += lost;
    return good;
}

// Without threads whoever puts takes too: the queue is empty again, and what is written is the same.
template <typename Fill>
void Recorder::put(EventType type, std::size_t size, Fill&& fill) {
    if (def_.waits) {
        while (!queue_.put(static_cast<std::uint32_t>(type), size, fill))
            std::this_thread::sleep_for(std::chrono::microseconds(100));
    } else if (!has_room_again() || !queue_.put(static_cast<std::uint32_t>(type), size, fill)) {
        lose();
    }
    if (!has_threads) take_all();
}

void Recorder::put(Event&& event) {
    if (!attached_) return writer_.write(event);  // the beginning
    auto* const whole = new Event(std::move(event));
    const auto fill = [&](std::uint8_t* to) {
        std::memcpy(to, &whole, sizeof whole);
        return sizeof whole;
    };
    while (!has_room_again() || !queue_.put(whole_event, sizeof whole, fill)) std::this_thread::sleep_for(nap);
    if (!has_threads) take_all();
}

void Recorder::work() {
    for (bool last = false; !last;) {
        {
            std::unique_lock<std::mutex> lock(lock_);
            wake_.wait_for(lock, nap, [&] { return closing_; });
            last = closing_;
        }
        take_all();
    }
}

void Recorder::take_all() {
    const auto one = [&](std::uint32_t type, const std::uint8_t* data, std::size_t size) {
        try {
            take(type, data, size);
        } catch (...) {
            if (!failure_) failure_ = std::current_exception();
        }
    };
    while (queue_.take(one)) bytes_.store(writer_.bytes(), std::memory_order_relaxed);
}

void Recorder::take(std::uint32_t type, const std::uint8_t* data, std::size_t size) {
    if (type == whole_event) {
        Event* whole = nullptr;
        std::memcpy(&whole, data, sizeof whole);
        const std::unique_ptr<Event> owner(whole);
        if (!failure_) writer_.write(*owner);
        return;
    }
    if (failure_) return;
    switch (static_cast<EventType>(type)) {
        case EventType::motion: {
            MotionBytes m;
            std::memcpy(static_cast<void*>(&m), data, sizeof m);
            taken_ = event::Motion{m.id, m.pose, m.twist};
            break;
        }
        case EventType::tick: {
            TickHead head;
            std::memcpy(&head, data, sizeof head);
            if (!std::holds_alternative<event::Tick>(taken_)) taken_ = event::Tick{};
            auto& tick = std::get<event::Tick>(taken_);
            tick.tick = head.tick, tick.time = head.time, tick.dt = head.dt;
            tick.has_hash = head.has_hash != 0, tick.hash = head.hash;
            tick.forces.resize(head.has_forces ? head.bodies : 0);
            tick.checks.resize(head.has_forces ? 0 : head.bodies);
            if (head.bodies > 0 && head.has_forces)
                std::memcpy(static_cast<void*>(tick.forces.data()), data + sizeof head, head.bodies * sizeof(Forces));
            else if (head.bodies > 0)
                std::memcpy(tick.checks.data(), data + sizeof head, head.bodies * sizeof(std::uint32_t));
            ticks_.store(head.tick, std::memory_order_relaxed);
            break;
        }
        case EventType::exchange: {
            ExchangeHead head;
            std::memcpy(&head, data, sizeof head);
            taken_ = event::Exchange{
                head.device, head.has_wrenches != 0, head.command, head.state, {data + sizeof head, data + size}};
            break;
        }
        default: {
            event::Gap gap;
            std::memcpy(&gap.events, data, sizeof gap.events);
            taken_ = gap;
            break;
        }
    }
    writer_.write(taken_);
}

void Recorder::add_device(Device& device) {
    if (devices_.size() == 16) throw Error(FRM_ERROR_LIMIT, "a recorder takes 16 devices");
    if (device.recorder) throw Error(FRM_ERROR_STATE, "this device is recorded already");
    const frm_device_info info = device.info();
    put(event::Device{info.serial, info.max_force, info.max_torque, info.name});
    device.recorded_as = static_cast<std::uint32_t>(devices_.size());
    device.recorder = this;
    device.exchanges_recorded = 0;
    devices_.push_back(&device);
}

void Recorder::forget(Device& device) {
    std::replace(devices_.begin(), devices_.end(), &device, static_cast<Device*>(nullptr));
}

void Recorder::exchanged(Device& device, const frm_device_command& command, const frm_device_state& state) {
    const bool has_wrenches = device.exchanges_recorded++ % def_.force_interval == 0;
    const ExchangeHead head{device.recorded_as, has_wrenches, command.wrench, state};
    put(EventType::exchange, sizeof head + largest_packet, [&](std::uint8_t* to) {
        std::memcpy(to, &head, sizeof head);
        return sizeof head + device.raw_within_exchange(to + sizeof head, largest_packet);
    });
}

void Recorder::water_created(const World& world) { put(event::Water{world.water()->def()}); }

void Recorder::water_destroyed(const World&) { put(event::WaterEnd{}); }

void Recorder::height_set(const World&, const float* height, std::size_t count) {
    put(event::Height{{height, height + count}});
}

void Recorder::pressure_set(const World&, const float* pressure, std::size_t count) {
    put(event::Pressure{{pressure, pressure + count}});
}

std::uint32_t Recorder::number_of(const std::shared_ptr<const Map>& map) {
    const auto found = std::find(maps_.begin(), maps_.end(), map);
    if (found != maps_.end()) return static_cast<std::uint32_t>(found - maps_.begin());
    event::Map e;
    e.file.assign(map->file.begin(), map->file.end());
    put(std::move(e));
    maps_.push_back(map);
    return static_cast<std::uint32_t>(maps_.size() - 1);
}

void Recorder::body_created(const World&, const Body& body) {
    const std::uint32_t map = number_of(body.def.map);
    put(event::Body{body.id, map, body.def});
}

void Recorder::body_destroyed(const World&, std::uint32_t id) { put(event::BodyEnd{id}); }

void Recorder::motion_set(const World&, const Body& body) {
    put(EventType::motion, sizeof(MotionBytes), [&](std::uint8_t* to) {
        const MotionBytes m{body.id, body.def.pose, body.def.twist};
        std::memcpy(to, static_cast<const void*>(&m), sizeof m);
        return sizeof m;
    });
}

void Recorder::ticked(const World& world, float dt) {
    TickHead head{world.ticks(),
                  0,
                  world.time(),
                  dt,
                  static_cast<std::uint32_t>(world.bodies().size()),
                  world.ticks() % def_.hash_interval == 0,
                  world.ticks() % def_.force_interval == 0};
    if (head.has_hash) head.hash = world.hash();
    const std::size_t size = sizeof head + head.bodies * (head.has_forces ? sizeof(Forces) : sizeof(std::uint32_t));
    if (def_.waits && size > queue_.capacity() / 2) {
        event::Tick tick{head.tick, head.time, dt, {}, {}, head.has_hash != 0, head.hash};
        for (const auto& body : world.bodies())
            if (head.has_forces)
                tick.forces.push_back(body->forces);
            else
                tick.checks.push_back(checks_of(body->forces));
        return put(std::move(tick));
    }
    put(EventType::tick, size, [&](std::uint8_t* to) {
        std::memcpy(to, &head, sizeof head);
        std::uint8_t* at = to + sizeof head;
        for (const auto& body : world.bodies()) {
            if (head.has_forces) {
                std::memcpy(at, static_cast<const void*>(&body->forces), sizeof(Forces));
                at += sizeof(Forces);
            } else {
                const std::uint32_t checks = checks_of(body->forces);
                std::memcpy(at, &checks, sizeof checks);
                at += sizeof checks;
            }
        }
        return static_cast<std::size_t>(at - to);
    });
}

}  // namespace frm::device
