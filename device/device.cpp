#include "device/device.h"

#include <cmath>

#include "core/error.h"
#include "device/recorder.h"

namespace frm::device {
namespace {

bool finite(const frm_vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

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

Device::Device(const frm_device_driver& driver, void* user, std::uint32_t index) : driver_(driver), user_(user) {
    require_success(driver_.open(user_, index, &instance_), "open");
}

Device::~Device() {
    if (recorder) recorder->forget(*this);
    driver_.stop(user_, instance_);
    driver_.close(user_, instance_);
}

frm_device_info Device::info() {
    frm_device_info out{};
    out.struct_size = sizeof out;
    require_success(driver_.info(user_, instance_, &out), "info");
    out.name[sizeof out.name - 1] = 0;
    return out;
}

void Device::calibrate() { require_success(driver_.calibrate(user_, instance_), "calibrate"); }

void Device::stop() { require_success(driver_.stop(user_, instance_), "stop"); }

frm_device_state Device::exchange(const api::Axes& axes, const frm_device_command& command) {
    if (!finite(command.wrench.force) || !finite(command.wrench.torque))
        throw Error(FRM_ERROR_ARGUMENT, "command.wrench is not finite; the device was not told");
    frm_device_state state{};
    state.struct_size = sizeof state;
    state.pose.rotation.w = 1;
    state.achieved = command.wrench;
    require_success(driver_.exchange(user_, instance_, &command, &state), "exchange");
    try {
        axes.pose_in(state.pose, "state.pose");
        axes.twist_in(state.twist, "state.twist");
        if (!std::isfinite(state.grip)) throw Error(FRM_ERROR_ARGUMENT, "state.grip is not finite");
    } catch (const Error& error) {
        driver_.stop(user_, instance_);
        throw Error(FRM_ERROR_DEVICE, "the device gave a state that cannot be (%s); it was stopped", error.text());
    }
    if (recorder) recorder->exchanged(recorded_as, command, state);
    return state;
}

}  // namespace frm::device
