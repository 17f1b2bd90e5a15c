// A device behind its handle, and the drivers that come with the library. The safety layer stands in here: there is no other
// way to a driver.
#pragma once

#include <atomic>

#include "core/api/objects.h"
#include "device/safety/safety.h"
#include "device/safety/watchdog.h"
#include "frm.h"

namespace frm::device {

class Recorder;

class Device : public api::Object {
public:
    /// Opens device `index` of the driver. `kept`: its stop() is called every few milliseconds while nobody exchanges, from a
    /// thread of the library, because it has something to follow. Throws Error (FRM_ERROR_DEVICE).
    Device(const frm_device_driver& driver, void* user, std::uint32_t index, bool kept = false);
    ~Device() override;

    frm_device_info info();
    void calibrate();
    frm_device_state exchange(const api::Axes& axes, const frm_device_command& command);
    void stop();
    /// The packet of the last exchange, at most `capacity` bytes of it; its size. 0: the driver gives none.
    std::size_t raw(std::uint8_t* data, std::size_t capacity);
    /// The same for the recorder, which an exchange calls.
    std::size_t raw_within_exchange(std::uint8_t* data, std::size_t capacity);

    void set_safety(const frm_device_safety_def& def);
    frm_device_safety_state safety() const;
    const frm_device_safety_def& safety_def() const { return safety_.def(); }
    std::uint32_t safety_faults() const { return safety_.latch().faults(); }
    /// Reads the device's limits and starts the watchdog, so that engage() only sets what is set in memory.
    void prepare();
    /// [realtime] after prepare().
    void engage();
    void disengage();
    void clear_fault();

    /// Who records the exchanges, and under which number; null for nobody.
    Recorder* recorder = nullptr;
    std::uint32_t recorded_as = 0;
    std::uint64_t exchanges_recorded = 0;
    /// The servo that has this device for itself, and whether its thread runs.
    std::uint32_t servos = 0;
    std::atomic<bool> served{false};

private:
    class Busy;
    static void stop_by_watchdog(void* self);
    static void keep_by_watchdog(void* self);
    void stop_driver();
    void require_possible(const api::Axes& axes, const frm_device_state& state);

    frm_device_driver driver_;
    void* user_;
    void* instance_ = nullptr;
    Safety safety_;
    Six most_;
    std::atomic<bool> busy_{false};  ///< a call of the driver is running
    Watchdog watchdog_;
};

/// Throws Error (FRM_ERROR_STATE) while a servo has the device.
inline void require_not_served(const Device& device) {
    if (device.served.load(std::memory_order_acquire))
        throw Error(FRM_ERROR_STATE, "a servo runs this device: use the servo's functions, or stop it");
}

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
