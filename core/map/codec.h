// The .frm file: docs/format.md. Reading trusts no byte; writing gives the same bytes for the same map.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "core/map/map.h"

namespace frm {

/// What is written; 1 is read as well.
constexpr std::uint32_t map_format_version = 2;

/// The file's bytes. The map must be complete.
std::vector<std::uint8_t> encode_map(const Map& map);

/// Fills an empty map (its `file` and `content_hash` too). Throws Error: FRM_ERROR_CORRUPT or FRM_ERROR_VERSION,
/// naming the chunk.
void decode_map(const std::uint8_t* data, std::size_t size, Map& map);

/// A zstd frame that knows its contents' size and checksum.
std::vector<std::uint8_t> compress(const std::vector<std::uint8_t>& raw, int level);

namespace format {

constexpr std::uint8_t magic[8] = {0x89, 'F', 'R', 'M', '\r', '\n', 0x1A, '\n'};
constexpr std::size_t header_bytes = 40;

/// Differences that are small numbers of either sign become small numbers: 0, -1, 1, -2, ... are 0, 1, 2, 3, ...
inline std::uint16_t fold(std::uint16_t difference) {
    const auto sign = static_cast<std::uint16_t>(difference & 0x8000u ? 0xFFFFu : 0u);
    return static_cast<std::uint16_t>((difference << 1) ^ sign);
}
inline std::uint16_t unfold(std::uint16_t folded) {
    const auto sign = static_cast<std::uint16_t>(folded & 1u ? 0xFFFFu : 0u);
    return static_cast<std::uint16_t>((folded >> 1) ^ sign);
}

/// What a mean is expected to be, from those of the neighbouring directions that have been told: their mean, rounded
/// down; 0 if there are none.
inline std::int32_t expected_mean(const std::int16_t* values, const Neighbours& known) {
    std::int32_t sum = 0;
    const auto count = static_cast<std::int32_t>(known.count);
    if (count == 0) return 0;
    for (std::int32_t i = 0; i < count; ++i) sum += values[known.index[i]];
    return sum >= 0 ? sum / count : -((count - 1 - sum) / count);
}

}  // namespace format

}  // namespace frm
