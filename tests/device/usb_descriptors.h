// What an amplifier on USB says of itself: one interface of the vendor's own with the two bulk endpoints.
#pragma once

#include <cstdint>
#include <vector>

namespace frm::test {

constexpr std::size_t usb_device_descriptor_bytes = 18;

/// The descriptor of the device, and after it that of its one configuration with all that belongs to it.
inline std::vector<std::uint8_t> usb_descriptors(unsigned vendor, unsigned product) {
    const auto low = [](unsigned v) { return static_cast<std::uint8_t>(v); };
    // clang-format off
    return {
        18, 1, 0x00, 0x02, 0xFF, 0, 0, 64, low(vendor), low(vendor >> 8), low(product), low(product >> 8), 0x00, 0x01, 0, 0, 0, 1,
        9, 2, 32, 0, 1, 1, 0, 0x80, 50,       // configuration
        9, 4, 0, 0, 2, 0xFF, 0, 0, 0,         // interface
        7, 5, 0x02, 2, 0x00, 0x02, 0,         // bulk out, 512
        7, 5, 0x86, 2, 0x00, 0x02, 0,         // bulk in
    };
    // clang-format on
}

}  // namespace frm::test
