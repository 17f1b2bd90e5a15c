// The .frm file: docs/format.md. Reading trusts no byte; writing gives the same bytes for the same map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "core/map/map.h"

namespace frm {

constexpr std::uint32_t map_format_version = 1;

/// The file's bytes. The map must be complete.
std::vector<std::uint8_t> encode_map(const Map& map);

/// Fills an empty map (its `file` and `content_hash` too). Throws Error: FRM_ERROR_CORRUPT or FRM_ERROR_VERSION,
/// naming the chunk.
void decode_map(const std::uint8_t* data, std::size_t size, Map& map);

namespace format {

constexpr std::uint8_t magic[8] = {0x89, 'F', 'R', 'M', '\r', '\n', 0x1A, '\n'};
constexpr std::size_t header_bytes = 40;

}  // namespace format

}  // namespace frm
