// The C entry points of servos.
#include "device/servo/servo.h"

using namespace frm;
using namespace frm::api;
using frm::device::Device;
using frm::device::Servo;
using frm::device::ServoDef;

namespace {

frm_servo_def default_servo() {
    frm_servo_def def{};
    const ServoDef defaults;
    def.rate = defaults.rate;
    def.grip.rotation.w = 1;
    def.priority = defaults.priority;
    def.lock_memory = defaults.lock_memory;
    return def;
}

ServoDef checked(const Axes& axes, const frm_servo_def& d) {
    require_range(d.rate, 100, 5000, "def.rate");
    require_range(d.priority, 0, 99, "def.priority");
    if (d.lock_memory > 1) throw Error(FRM_ERROR_ARGUMENT, "def.lock_memory = %u is not 0 or 1", d.lock_memory);
    axes.pose_in(d.grip, "def.grip");
    ServoDef out{d.rate, d.priority, d.lock_memory != 0, d.grip, d.on_tick, d.user};
    out.grip.rotation = device::unit(d.grip.rotation, "def.grip.rotation");
    return out;
}

}  // namespace

frm_status FRM_CALL frm_servo_def_init(frm_servo_def* def, uint64_t size) {
    return init_def(def, size, default_servo());
}

frm_status FRM_CALL frm_servo_input_init(frm_servo_input* input, uint64_t size) {
    return init_def(input, size, device::default_input());
}

frm_status FRM_CALL frm_servo_create(frm_context context, const frm_servo_def* def, frm_servo* servo) {
    return with_context(context, [&](Context& c) {
        require_pointer(def, "def");
        require_pointer(servo, "servo");
        const frm_servo_def d = read_def(def, default_servo(), "def");
        const ServoDef settings = checked(c.axes(), d);
        Object* body = c.find(d.body, Kind::body);
        if (!body) throw Error(FRM_ERROR_HANDLE, "def.body is not a body of this context, or it is no more");
        Object* device = c.find(d.device, Kind::device);
        if (!device) throw Error(FRM_ERROR_HANDLE, "def.device is not a device of this context, or it is no more");
        auto& held = static_cast<BodyObject&>(*body);
        auto& drives = static_cast<Device&>(*device);
        require_changeable(held.world);
        if (drives.servos > 0) throw Error(FRM_ERROR_STATE, "def.device has a servo already");
        *servo = c.add(Kind::servo, c.make<Servo>(c.axes(), settings, held, drives));
    });
}

frm_status FRM_CALL frm_servo_destroy(frm_servo servo) {
    return with<Servo>(servo, [&](Context& c, Servo&) { c.remove(servo); });
}

frm_status FRM_CALL frm_servo_start(frm_servo servo) {
    return with<Servo>(servo, [&](Context&, Servo& object) { object.start(); });
}

frm_status FRM_CALL frm_servo_stop(frm_servo servo) {
    return with<Servo>(servo, [&](Context&, Servo& object) { object.stop(); });
}

frm_status FRM_CALL frm_servo_set_input(frm_servo servo, const frm_servo_input* input) {
    return with<Servo>(servo, [&](Context& c, Servo& object) {
        require_pointer(input, "input");
        object.set_input(device::checked_input(c.axes(), read_def(input, device::default_input(), "input")));
    });
}

frm_status FRM_CALL frm_servo_engage(frm_servo servo) {
    return with<Servo>(servo, [&](Context&, Servo& object) { object.engage(true); });
}

frm_status FRM_CALL frm_servo_disengage(frm_servo servo) {
    return with<Servo>(servo, [&](Context&, Servo& object) { object.engage(false); });
}

frm_status FRM_CALL frm_servo_clear_fault(frm_servo servo) {
    return with<Servo>(servo, [&](Context&, Servo& object) { object.clear_fault(); });
}

frm_status FRM_CALL frm_servo_get_state(frm_servo servo, frm_servo_state* state) {
    return with<Servo>(servo, [&](Context&, Servo& object) {
        require_out(state, "state");
        write_struct(state, object.state());
    });
}

frm_status FRM_CALL frm_servo_get_stats(frm_servo servo, frm_servo_stats* stats) {
    return with<Servo>(servo, [&](Context&, Servo& object) {
        require_out(stats, "stats");
        write_struct(stats, object.stats());
    });
}

frm_status FRM_CALL frm_servo_get_histogram(frm_servo servo, uint32_t which, uint64_t* edges, uint64_t* counts,
                                            uint32_t capacity, uint32_t* count) {
    return with<Servo>(servo, [&](Context&, Servo& object) {
        using device::Histogram;
        require_pointer(count, "count");
        if (which > FRM_SERVO_LATE) throw Error(FRM_ERROR_ARGUMENT, "which = %u is not an frm_servo_time", which);
        *count = Histogram::bins;
        if (!edges && !counts) return;
        if (capacity < Histogram::bins)
            throw Error(FRM_ERROR_CAPACITY, "the arrays take %u bins; there are %u", capacity, Histogram::bins);
        const Histogram& histogram = which == FRM_SERVO_TICK ? object.tick_times() : object.lateness();
        for (std::uint32_t i = 0; i < Histogram::bins; ++i) {
            if (edges) edges[i] = Histogram::edge(i);
            if (counts) counts[i] = histogram.count(i);
        }
    });
}
