// A servo behind its handle: the loop on a thread of its own, at absolute deadlines.
#pragma once

#include <atomic>
#include <memory>
#include <thread>

#include "device/servo/latest.h"
#include "device/servo/loop.h"

namespace frm::device {

struct ServoDef {
    std::uint32_t rate = 1000, priority = 80;
    bool lock_memory = true;
    frm_pose grip{};
    frm_servo_tick_fn on_tick = nullptr;
    void* user = nullptr;
};

class Servo : public api::Object {
public:
    Servo(const api::Axes& axes, const ServoDef& def, api::BodyObject& body, Device& device);
    ~Servo() override;

    void start();
    void stop();
    void set_input(const frm_servo_input& input);
    void engage(bool engage);
    void clear_fault();

    /// [any]
    frm_servo_state state() const;
    frm_servo_stats stats() const;
    const Histogram& tick_times() const { return tick_times_; }
    const Histogram& lateness() const { return lateness_; }

private:
    frm_servo_state beginning() const;
    void run();
    void tick_at_deadlines();
    void claim();
    void release();

    const api::Axes& axes_;
    ServoDef def_;
    api::BodyObject& body_;
    api::WorldObject& world_;
    Device& device_;
    std::int64_t period_;

    std::thread thread_;
    std::atomic<bool> quit_{false}, running_{false}, realtime_{false}, locked_{false};
    ServoRequests requests_;  ///< the host's side of asked_
    Latest<ServoRequests> asked_;
    Latest<frm_servo_state> newest_;
    Histogram tick_times_, lateness_;
    Counter ticks_, missed_, skipped_, failed_exchanges_, diverged_;
};

}  // namespace frm::device

template <>
struct frm::api::KindOf<frm::device::Servo> {
    static constexpr Kind kind = Kind::servo;
};
