// Boards of the HID class, through hidapi: one packet of the amplifier's in one report.
#pragma once

#include <memory>
#include <vector>

#include "device/spidar_g/transport.h"

namespace frm::spidar_g {

/// Every board of the configuration's vendor and product that can be opened, in the order of its paths. Throws Error:
/// FRM_ERROR_UNSUPPORTED without hidapi, FRM_ERROR_DEVICE if boards are there but none may be opened.
std::vector<std::unique_ptr<Transport>> open_hid(const Configuration& configuration);

}  // namespace frm::spidar_g
