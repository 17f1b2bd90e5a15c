#include <algorithm>
#include <cstring>
#include <memory>
#include <vector>

#include "core/error.h"
#include "device/device.h"
#include "device/recording_columns.h"

namespace frm::device {
namespace {

struct ReplayDevice {
    event::Device device;
    std::vector<frm_device_state> states;
    std::vector<std::vector<std::uint8_t>> packets;
    std::size_t next = 0;
};

/// Between two exchanges whose wrenches were kept, the wrench achieved stays as it was.
void keep_achieved(const frm_device_state& before, frm_device_state& now) {
    constexpr std::size_t size = std::min<std::size_t>(sizeof now - named_state_bytes, 4 * achieved_words);
    std::memcpy(reinterpret_cast<unsigned char*>(&now) + named_state_bytes,
                reinterpret_cast<const unsigned char*>(&before) + named_state_bytes, size);
}

std::unique_ptr<ReplayDevice> read(const ReplaySource& source) {
    RecordingReader reader(source.path);
    auto out = std::make_unique<ReplayDevice>();
    std::uint32_t devices = 0;
    Event e;
    while (reader.next(e)) {
        if (const auto* world = std::get_if<event::World>(&e)) {
            if (world->axes != source.axes)
                throw Error(FRM_ERROR_STATE, "%s: recorded with other axes (frm_axes %u) than this context's (%u)",
                            source.path, world->axes, source.axes);
        } else if (const auto* device = std::get_if<event::Device>(&e)) {
            if (devices++ == source.device) out->device = *device;
        } else if (const auto* exchange = std::get_if<event::Exchange>(&e)) {
            if (exchange->device != source.device) continue;
            frm_device_state state = exchange->state;
            if (!exchange->has_wrenches && !out->states.empty()) keep_achieved(out->states.back(), state);
            out->states.push_back(state);
            out->packets.push_back(exchange->raw);
        } else if (std::holds_alternative<event::Gap>(e)) {
            break;
        }
    }
    if (source.device >= devices)
        throw Error(FRM_ERROR_STATE, "%s: holds %u devices, so there is no device %u", source.path, devices,
                    source.device);
    return out;
}

// The recording is opened by the library's own caller, so that its errors keep their text.
frm_status FRM_CALL open(void* user, std::uint32_t, void** instance) {
    *instance = read(*static_cast<const ReplaySource*>(user)).release();
    return FRM_OK;
}

frm_status FRM_CALL enumerate(void*, frm_device_info*, std::uint32_t, std::uint32_t* count) {
    *count = 1;
    return FRM_OK;
}

frm_status FRM_CALL close(void*, void* instance) {
    delete static_cast<ReplayDevice*>(instance);
    return FRM_OK;
}

frm_status FRM_CALL info(void*, void* instance, frm_device_info* out) {
    const event::Device& d = static_cast<const ReplayDevice*>(instance)->device;
    out->serial = d.serial;
    out->max_force = d.max_force;
    out->max_torque = d.max_torque;
    std::strncpy(out->name, d.name.c_str(), sizeof out->name - 1);
    return FRM_OK;
}

frm_status FRM_CALL calibrate(void*, void*) { return FRM_OK; }

frm_status FRM_CALL exchange(void*, void* instance, const frm_device_command*, frm_device_state* state) {
    auto& device = *static_cast<ReplayDevice*>(instance);
    if (device.next == device.states.size()) return FRM_ERROR_END;
    *state = device.states[device.next++];
    return FRM_OK;
}

frm_status FRM_CALL stop(void*, void*) { return FRM_OK; }

frm_status FRM_CALL raw(void*, void* instance, std::uint8_t* data, std::uint32_t capacity, std::uint32_t* size) {
    const auto& device = *static_cast<ReplayDevice*>(instance);
    if (device.next == 0) return FRM_OK;
    const std::vector<std::uint8_t>& packet = device.packets[device.next - 1];
    *size = std::min(capacity, static_cast<std::uint32_t>(packet.size()));
    std::copy_n(packet.begin(), *size, data);
    return FRM_OK;
}

}  // namespace

const frm_device_driver& replay_driver() {
    static const frm_device_driver driver{
        sizeof(frm_device_driver), 0, enumerate, open, close, info, calibrate, exchange, stop, raw};
    return driver;
}

}  // namespace frm::device
