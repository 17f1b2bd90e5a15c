// The .frmraw file: a map's tables before they were rounded, so that the error that the map states can be checked by
// others, and what rounding saves can be seen (docs/format.md).
#pragma once

#include <cstdint>
#include <vector>

#include "bake/map/fill.h"

namespace frm::bake {

constexpr std::uint32_t raw_format_version = 1;
constexpr std::uint8_t raw_magic[8] = {0x89, 'F', 'R', 'W', '\r', '\n', 0x1A, '\n'};  ///< its first bytes

/// The file's bytes. `map` is the one that fill_tables() filled from the tables. Throws Error if their sizes do not match.
std::vector<std::uint8_t> encode_raw(const Map& map, const Tables& tables);

/// Trusts no byte. Throws Error: FRM_ERROR_CORRUPT or FRM_ERROR_VERSION if it is damaged or unknown, FRM_ERROR_ARGUMENT
/// if it is of another map (of another object, or of other directions, speeds, samples or facts).
Tables decode_raw(const std::uint8_t* data, std::size_t size, const Map& map);

}  // namespace frm::bake
