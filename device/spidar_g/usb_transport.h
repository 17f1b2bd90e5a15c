// Amplifiers on USB, through libusb's asynchronous interface: all transfers of a cycle are on their way at once.
#pragma once

#include <memory>
#include <vector>

#include "device/spidar_g/transport.h"

namespace frm::spidar_g {

/// Every amplifier of the configuration's vendor and product that can be opened, in the order of bus and port. Throws
/// Error: FRM_ERROR_UNSUPPORTED without libusb, FRM_ERROR_DEVICE if libusb fails, or if devices are there but none may
/// be opened.
std::vector<std::unique_ptr<Transport>> open_usb(const Configuration& configuration);

}  // namespace frm::spidar_g
