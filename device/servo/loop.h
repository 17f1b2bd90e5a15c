// One tick of a servo, without its thread and its clock: exchange, move, tick, and what to send next.
#pragma once

#include "core/api/objects.h"
#include "device/device.h"
#include "device/servo/attachment.h"
#include "device/servo/drag_limit.h"
#include "device/servo/statistics.h"

namespace frm::device {

frm_servo_input default_input();
/// Throws Error (FRM_ERROR_ARGUMENT) naming the field; rotations have length 1 afterwards.
frm_servo_input checked_input(const api::Axes& axes, const frm_servo_input& input);

/// What the host asks a servo for. Counts grow with each request, so that none is lost between two ticks.
struct ServoRequests {
    frm_servo_input input = default_input();
    std::uint32_t engaging = 0;  ///< changes of `engage`
    std::uint32_t clearing = 0;
    bool engage = false;
};

class ServoLoop {
public:
    struct Parts {
        const api::Axes& axes;
        World& world;
        Body& body;
        Device& device;
        frm_pose grip;
        std::uint32_t rate;
        frm_servo_tick_fn on_tick;
        void* user;
    };
    explicit ServoLoop(const Parts& parts);

    /// False if the loop is at its end: state().status says why.
    bool tick(const ServoRequests& requests);
    const frm_servo_state& state() const { return state_; }
    const Counter& failed_exchanges() const { return failed_exchanges_; }
    const Counter& diverged() const { return diverged_; }

private:
    void follow(const ServoRequests& requests);
    bool exchange();
    void move();
    bool tick_world();
    void feel(const ServoRequests& requests);
    Wrench borne(const Wrench& wrench, const Vec3f& arm, const frm_servo_input& input);
    void fail(frm_status status, const char* text);

    Parts parts_;
    float dt_;
    ServoRequests seen_;
    Attachment attachment_;
    frm_device_command command_{};
    DragLimit drag_limit_;
    frm_device_state grip_{};
    frm_servo_state state_{};
    std::uint32_t rest_ = 0;  ///< ticks before a device that failed is asked again
    Counter failed_exchanges_, diverged_;
};

}  // namespace frm::device
