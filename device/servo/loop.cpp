#include "device/servo/loop.h"

#include <cstdio>
#include <cstring>

#include "core/body/coefficients.h"

namespace frm::device {
namespace {

frm_vec3 plain(const Vec3f& v) { return {v.x, v.y, v.z}; }

}  // namespace

frm_servo_input default_input() {
    frm_servo_input input{};
    input.struct_size = sizeof input;
    input.motion_scale = input.force_scale = input.torque_scale = 1;
    input.anchor.rotation.w = 1;
    return input;
}

frm_servo_input checked_input(const api::Axes& axes, const frm_servo_input& input) {
    api::require_range(static_cast<double>(input.motion_scale), 1e-3f, 1e3, "input.motion_scale");
    api::require_range(static_cast<double>(input.force_scale), 0, 1e3, "input.force_scale");
    api::require_range(static_cast<double>(input.torque_scale), 0, 1e3, "input.torque_scale");
    for (const frm_vec3* v : {&input.extra.force, &input.extra.torque})
        for (const float part : {v->x, v->y, v->z})
            api::require_range(static_cast<double>(part), -1e6, 1e6, "input.extra");
    axes.pose_in(input.anchor, "input.anchor");
    frm_servo_input out = input;
    out.anchor.rotation = unit(input.anchor.rotation, "input.anchor.rotation");
    return out;
}

ServoLoop::ServoLoop(const Parts& parts) : parts_(parts), dt_(1.0f / static_cast<float>(parts.rate)) {
    attachment_.anchor = seen_.input.anchor;
    attachment_.grip = parts.grip;
    command_.struct_size = sizeof command_;
    grip_.pose.rotation.w = 1;
    state_.struct_size = sizeof state_;
    state_.pose = parts.axes.pose_out(parts.body.def.pose);
}

void ServoLoop::follow(const ServoRequests& requests) {
    attachment_.anchor = requests.input.anchor;
    attachment_.motion_scale = requests.input.motion_scale;
    if (requests.clearing != seen_.clearing) {
        parts_.device.clear_fault();
        rest_ = 0;
        state_.status = FRM_OK;
    }
    if (requests.engaging != seen_.engaging) {
        if (!requests.engage)
            parts_.device.disengage();
        else if (parts_.device.safety_faults() == 0)
            parts_.device.engage();
    }
    seen_ = requests;
}

void ServoLoop::fail(frm_status status, const char* text) {
    state_.status = status;
    std::snprintf(state_.reason, sizeof state_.reason, "%.127s", text);
}

// A device that failed is asked again ten times a second only: a call may take until its time-out, and the water goes on.
bool ServoLoop::exchange() {
    if (rest_ > 0) {
        --rest_;
        return true;
    }
    try {
        grip_ = parts_.device.exchange(parts_.axes, command_);
    } catch (const Error& error) {
        failed_exchanges_.add();
        grip_.twist = {};
        grip_.status = FRM_DEVICE_FAULT;
        fail(error.status(), error.text());
        if (error.status() == FRM_ERROR_END) return false;
        rest_ = parts_.rate / 10;
    }
    return true;
}

void ServoLoop::move() {
    state_.pose = body_pose(attachment_, grip_.pose);
    state_.twist = body_twist(attachment_, grip_.pose, grip_.twist);
    parts_.world.set_motion(parts_.body, parts_.axes.pose_in(state_.pose, "the body's pose"),
                            parts_.axes.twist_in(state_.twist, "the body's twist"));
}

bool ServoLoop::tick_world() {
    if (parts_.on_tick) {
        const frm_status status = parts_.on_tick(parts_.user, state_.ticks, dt_);
        if (status != FRM_OK) {
            fail(status, "on_tick ended the servo");
            return false;
        }
    }
    if (!parts_.world.tick(dt_)) {
        diverged_.add();
        fail(FRM_ERROR_DIVERGED, "a force was not a finite number; the water has been made calm");
    }
    ++state_.ticks;
    state_.time = parts_.world.time();
    return true;
}

/// What of a wrench about the grip it can be made to feel; `arm`: from there to the body's origin.
Wrench ServoLoop::borne(const Wrench& wrench, const Vec3f& arm, const frm_servo_input& in) {
    const frm_device_safety_def& safety = parts_.device.safety_def();
    if (!safety.passivity || !state_.engaged) {
        drag_limit_.reset();
        return wrench;
    }
    const Coefficients c = coefficients_of(parts_.body, parts_.world.def().fluid);
    return drag_limit_.limit(wrench, about(Vec3d(arm), c.damping), static_cast<double>(dt_),
                             {static_cast<double>(in.force_scale * in.motion_scale / safety.grip_mass),
                              static_cast<double>(in.torque_scale / safety.grip_inertia)});
}

void ServoLoop::feel(const ServoRequests& requests) {
    const frm_servo_input& in = requests.input;
    state_.wrench = parts_.axes.wrench_out(parts_.body.forces.total);
    // In frm's own axes, which are those of the coefficients.
    const Vec3f arm = parts_.axes.vector_in(plain(lever(attachment_, grip_.pose)));
    const Wrench felt = borne(about_grip(arm, parts_.body.forces.total), arm, in);
    const frm_wrench out = parts_.axes.wrench_out(felt);
    const auto scale = [](const frm_vec3& v, float by, const frm_vec3& more) {
        return frm_vec3{v.x * by + more.x, v.y * by + more.y, v.z * by + more.z};
    };
    command_.wrench = in_device(attachment_, {scale(out.force, in.force_scale, in.extra.force),
                                              scale(out.torque, in.torque_scale, in.extra.torque)});
}

bool ServoLoop::tick(const ServoRequests& requests) {
    bool goes_on = false;
    try {
        follow(requests);
        goes_on = exchange();
        if (goes_on) {
            move();
            goes_on = tick_world();
            feel(requests);
        }
    } catch (const Error& error) {
        fail(error.status(), error.text());
        goes_on = false;
    } catch (...) {
        fail(FRM_ERROR_INTERNAL, "an unexpected error inside the library");
        goes_on = false;
    }
    state_.displayed = grip_.achieved;
    state_.grip_pose = grip_.pose;
    state_.grip = grip_.grip;
    state_.buttons = grip_.buttons;
    state_.device_status = grip_.status;
    const frm_device_safety_state safety = parts_.device.safety();
    state_.engaged = safety.engaged;
    state_.faults = safety.faults;
    state_.ramp = safety.ramp;
    state_.energy = safety.energy;
    if (safety.faults != 0)
        std::memcpy(state_.reason, safety.reason, sizeof state_.reason);
    else if (state_.status == FRM_OK)
        std::memset(state_.reason, 0, sizeof state_.reason);
    return goes_on;
}

}  // namespace frm::device
