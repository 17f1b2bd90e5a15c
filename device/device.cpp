#include "device/device.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "core/error.h"
#include "device/recorder.h"

namespace frm::device {
namespace {

bool finite(const frm_vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }
bool finite(const frm_wrench& w) { return finite(w.force) && finite(w.torque); }
Vec3f plain(const frm_vec3& v) { return {v.x, v.y, v.z}; }
frm_vec3 plain(const Vec3f& v) { return {v.x, v.y, v.z}; }

void require_success(frm_status status, const char* what) {
    if (status == FRM_ERROR_END) throw Error(FRM_ERROR_END, "the device has no more to give");
    if (status != FRM_OK)
        throw Error(FRM_ERROR_DEVICE, "the device's driver failed in %s: %s", what, frm_status_name(status));
}

}  // namespace

frm_device_driver checked_driver(const frm_device_driver* driver) {
    api::require_pointer(driver, "driver");
    const frm_device_driver d = api::read_def(driver, frm_device_driver{}, "driver");
    if (!d.enumerate || !d.open || !d.close || !d.info || !d.calibrate || !d.exchange || !d.stop)
        throw Error(FRM_ERROR_ARGUMENT, "driver lacks a function: all seven are needed");
    return d;
}

/// One call of the driver at a time. It is only ever waited for while the watchdog stops a device whose host has stalled, or
/// keeps one going that nobody talked to.
class Device::Busy {
public:
    explicit Busy(std::atomic<bool>& flag) : flag_(flag) {
        // Asleep: whoever yields at a real-time priority leaves the watchdog no time on the same core.
        while (flag_.exchange(true, std::memory_order_acquire))
            std::this_thread::sleep_for(std::chrono::microseconds(20));
    }
    ~Busy() { flag_.store(false, std::memory_order_release); }
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;

private:
    std::atomic<bool>& flag_;
};

Device::Device(const frm_device_driver& driver, void* user, std::uint32_t index, bool kept)
    : driver_(driver),
      user_(user),
      watchdog_(&Device::stop_by_watchdog, kept ? &Device::keep_by_watchdog : nullptr, this) {
    require_success(driver_.open(user_, index, &instance_), "open");
    if (!kept) return;
    try {
        watchdog_.begin();
    } catch (...) {
        driver_.close(user_, instance_);
        throw;
    }
}

Device::~Device() {
    watchdog_.end();
    if (recorder) recorder->forget(*this);
    driver_.stop(user_, instance_);
    driver_.close(user_, instance_);
}

void Device::stop_by_watchdog(void* self) {
    auto& device = *static_cast<Device*>(self);
    if (device.busy_.exchange(true, std::memory_order_acquire)) return;
    if (device.watchdog_.overdue()) {
        device.driver_.stop(device.user_, device.instance_);
        device.watchdog_.expire();
    }
    device.busy_.store(false, std::memory_order_release);
}

void Device::keep_by_watchdog(void* self) {
    auto& device = *static_cast<Device*>(self);
    if (device.busy_.exchange(true, std::memory_order_acquire)) return;
    device.driver_.stop(device.user_, device.instance_);
    device.busy_.store(false, std::memory_order_release);
}

frm_device_info Device::info() {
    frm_device_info out{};
    out.struct_size = sizeof out;
    const Busy busy(busy_);
    require_success(driver_.info(user_, instance_, &out), "info");
    out.name[sizeof out.name - 1] = 0;
    return out;
}

void Device::calibrate() {
    const Busy busy(busy_);
    // What was felt until now was of other poses.
    safety_.restart();
    require_success(driver_.calibrate(user_, instance_), "calibrate");
}

void Device::stop() {
    watchdog_.feed(0);
    const Busy busy(busy_);
    safety_.disengage();
    safety_.stopped();
    require_success(driver_.stop(user_, instance_), "stop");
}

void Device::stop_driver() {
    driver_.stop(user_, instance_);
    safety_.stopped();
}

void Device::set_safety(const frm_device_safety_def& def) {
    if (safety_.engaged()) throw Error(FRM_ERROR_STATE, "the device is engaged: disengage it first");
    require_safety(def);
    safety_.configure(def);
}

frm_device_safety_state Device::safety() const {
    frm_device_safety_state out{};
    safety_.describe(out);
    return out;
}

void Device::prepare() {
    const frm_device_info own = info();
    // A driver's limits are limits only if they are numbers.
    const auto most = [](float v) { return v > 0 && std::isfinite(v) ? v : 0.0f; };
    most_.linear.x = most(own.max_force);
    most_.angular.x = most(own.max_torque);
    watchdog_.begin();
}

void Device::engage() {
    if (safety_.faulty())
        throw Error(FRM_ERROR_STATE, "a fault is latched (%s): clear it first", safety_.latch().reason());
    safety_.engage(most_);
}

void Device::disengage() { safety_.disengage(); }

void Device::clear_fault() { safety_.clear_fault(); }

void Device::require_possible(const api::Axes& axes, const frm_device_state& state) {
    try {
        axes.pose_in(state.pose, "state.pose");
        axes.twist_in(state.twist, "state.twist");
        if (!std::isfinite(state.grip)) throw Error(FRM_ERROR_ARGUMENT, "state.grip is not finite");
        if (!finite(state.achieved)) throw Error(FRM_ERROR_ARGUMENT, "state.achieved is not finite");
    } catch (const Error& error) {
        safety_.fault(FRM_DEVICE_FAULT_STATE);
        stop_driver();
        throw Error(FRM_ERROR_DEVICE, "the device gave a state that cannot be (%s); it was stopped", error.text());
    }
}

frm_device_state Device::exchange(const api::Axes& axes, const frm_device_command& command) {
    const Busy busy(busy_);
    if (!finite(command.wrench)) {
        // Told nothing, an engaged device would go on with the force that it has.
        if (safety_.fault(FRM_DEVICE_FAULT_COMMAND)) stop_driver();
        throw Error(FRM_ERROR_ARGUMENT, "command.wrench is not finite; the device was not told");
    }
    if (watchdog_.take_expired()) {
        safety_.stopped();
        safety_.fault(FRM_DEVICE_FAULT_DEADLINE);
    }
    frm_device_command out = command;
    if (out.deadline_ns == 0) out.deadline_ns = safety_.def().deadline_ns;
    const bool was_faulty = safety_.faulty();
    const Six sent = safety_.limit({plain(command.wrench.force), plain(command.wrench.torque)}, out.deadline_ns);
    if (safety_.faulty() && !was_faulty) stop_driver();
    out.wrench = {plain(sent.linear), plain(sent.angular)};

    frm_device_state state{};
    state.struct_size = sizeof state;
    state.pose.rotation.w = 1;
    state.achieved = out.wrench;
    const frm_status status = driver_.exchange(user_, instance_, &out, &state);
    watchdog_.feed(safety_.engaged() ? out.deadline_ns : 0);
    if (status != FRM_OK) {
        if (status == FRM_ERROR_END)
            safety_.disengage();
        else if (safety_.fault(FRM_DEVICE_FAULT_DRIVER))
            stop_driver();
        require_success(status, "exchange");
    }
    require_possible(axes, state);
    if (safety_.observe(state)) stop_driver();
    if (!safety_.engaged()) watchdog_.feed(0);
    // What the driver said: told the same again, the safety layer comes to the same again.
    if (recorder) recorder->exchanged(*this, command, state);
    if (safety_.faulty() && state.status == FRM_DEVICE_READY) state.status = FRM_DEVICE_FAULT;
    return state;
}

std::size_t Device::raw(std::uint8_t* data, std::size_t capacity) {
    const Busy busy(busy_);
    return raw_within_exchange(data, capacity);
}

std::size_t Device::raw_within_exchange(std::uint8_t* data, std::size_t capacity) {
    if (!driver_.raw) return 0;
    std::uint32_t size = 0;
    const auto most = static_cast<std::uint32_t>(std::min<std::size_t>(capacity, largest_packet));
    if (driver_.raw(user_, instance_, data, most, &size) != FRM_OK) return 0;
    return std::min(size, most);
}

}  // namespace frm::device
