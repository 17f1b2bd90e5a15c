// Integers as the amplifiers write them.
#pragma once

#include <cstdint>

namespace frm::spidar_g {

inline void put16(std::uint8_t* at, std::uint16_t value) {
    at[0] = static_cast<std::uint8_t>(value);
    at[1] = static_cast<std::uint8_t>(value >> 8);
}

inline std::uint16_t get16(const std::uint8_t* at) { return static_cast<std::uint16_t>(at[0] | at[1] << 8); }

inline void put24(std::uint8_t* at, std::uint32_t value) {
    put16(at, static_cast<std::uint16_t>(value));
    at[2] = static_cast<std::uint8_t>(value >> 16);
}

/// Signed.
inline std::int32_t get24(const std::uint8_t* at) {
    const std::int32_t value = at[0] | at[1] << 8 | at[2] << 16;
    return value >= 0x800000 ? value - 0x1000000 : value;
}

}  // namespace frm::spidar_g
