#include <cstring>
#include <new>

#include "device/device.h"

namespace frm::device {
namespace {

constexpr std::uint64_t cycle_ns = 2'000'000;

struct NullDevice {
    std::uint64_t exchanges = 0;
};

void describe(frm_device_info& info) {
    info.period_ns = cycle_ns;
    std::strncpy(info.name, "null", sizeof info.name - 1);
}

frm_status FRM_CALL enumerate(void*, frm_device_info* list, std::uint32_t capacity, std::uint32_t* count) {
    *count = 1;
    if (list && capacity > 0) describe(list[0]);
    return FRM_OK;
}

frm_status FRM_CALL open(void*, std::uint32_t index, void** instance) {
    if (index != 0) return FRM_ERROR_ARGUMENT;
    *instance = new (std::nothrow) NullDevice;
    return *instance ? FRM_OK : FRM_ERROR_MEMORY;
}

frm_status FRM_CALL close(void*, void* instance) {
    delete static_cast<NullDevice*>(instance);
    return FRM_OK;
}

frm_status FRM_CALL info(void*, void*, frm_device_info* out) {
    describe(*out);
    return FRM_OK;
}

frm_status FRM_CALL calibrate(void*, void*) { return FRM_OK; }

frm_status FRM_CALL exchange(void*, void* instance, const frm_device_command*, frm_device_state* state) {
    auto& device = *static_cast<NullDevice*>(instance);
    state->status = FRM_DEVICE_READY;
    state->sequence = device.exchanges;
    state->time_ns = device.exchanges * cycle_ns;
    ++device.exchanges;
    return FRM_OK;
}

frm_status FRM_CALL stop(void*, void*) { return FRM_OK; }

}  // namespace

const frm_device_driver& null_driver() {
    static const frm_device_driver driver{
        sizeof(frm_device_driver), 0, enumerate, open, close, info, calibrate, exchange, stop, nullptr};
    return driver;
}

}  // namespace frm::device
