// SPIDAR-G behind the driver table of frm.h.
#pragma once

#include <memory>

#include "core/api/axes.h"
#include "device/spidar_g/spidar_g.h"

namespace frm::simulated {
class SimulatedTransport;
}

namespace frm::spidar_g {

/// What `user` points to while a device is opened; the instance keeps nothing of it.
struct Source {
    const char* configuration;  ///< a path, or null
    std::int32_t rotary;        ///< -1: any
    std::uint32_t axes;
    bool simulated;
    simulated::SimulatedTransport** simulation = nullptr;  ///< receives what is behind a simulated device; may be null
};

const frm_device_driver& driver();

}  // namespace frm::spidar_g
