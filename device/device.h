// A device behind its handle, and the drivers that come with the library.
#pragma once

#include "core/api/objects.h"
#include "frm.h"

namespace frm::device {

class Recorder;

class Device : public api::Object {
public:
    /// Opens device `index` of the driver. Throws Error (FRM_ERROR_DEVICE).
    Device(const frm_device_driver& driver, void* user, std::uint32_t index);
    ~Device() override;

    frm_device_info info();
    void calibrate();
    frm_device_state exchange(const api::Axes& axes, const frm_device_command& command);
    void stop();
    /// The packet of the last exchange, at most `capacity` bytes of it; its size. 0: the driver gives none.
    std::size_t raw(std::uint8_t* data, std::size_t capacity);

    /// Who records the exchanges, and under which number; null for nobody.
    Recorder* recorder = nullptr;
    std::uint32_t recorded_as = 0;
    std::uint64_t exchanges_recorded = 0;

private:
    frm_device_driver driver_;
    void* user_;
    void* instance_ = nullptr;
};

/// Throws Error for a driver that lacks a function.
frm_device_driver checked_driver(const frm_device_driver* driver);

/// A device that is not there.
const frm_device_driver& null_driver();

/// A device that moves as in a recording; `user` is a ReplaySource, which the instance takes over.
struct ReplaySource {
    const char* path;
    std::uint32_t device;
    std::uint32_t axes;
};
const frm_device_driver& replay_driver();

}  // namespace frm::device

template <>
struct frm::api::KindOf<frm::device::Device> {
    static constexpr Kind kind = Kind::device;
};
