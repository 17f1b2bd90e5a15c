#include "bake/map/raw.h"

#include <zstd.h>

#include <cstring>

#include "core/error.h"
#include "core/map/bytes.h"
#include "core/map/codec.h"
#include "core/math/hash.h"

namespace frm::bake {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t header_bytes = 8 + 4 + 4 + 8 + 8;
constexpr std::uint64_t max_raw_bytes = 4 * (Map::max_fluctuations + Map::max_means);

[[noreturn]] void corrupt(const char* what) { throw Error(FRM_ERROR_CORRUPT, "raw tables: %s", what); }

/// What tables and map must have in common: what was solved, not how it was rounded.
std::uint64_t identity(const Map& map) {
    Bytes raw;
    ByteWriter<Bytes> w(raw);
    for (const float v :
         {map.facts.base_speed, map.facts.period, map.facts.density, map.facts.viscosity, map.facts.reference_length})
        w.f32(v);
    w.u32(map.samples);
    w.u32(map.directions.frequency());
    w.u32(map.fluctuation_directions.frequency());
    for (const float u : map.speeds) w.f32(u);
    for (const Source& s : map.sources) {
        w.vec3(s.position);
        w.vec3(s.normal);
        w.f32(s.area);
    }
    return fnv1a(raw.data(), raw.size());
}

struct Sizes {
    std::size_t means, fluctuations, fluctuation;  ///< forces; directions; numbers of one direction
    std::uint64_t bytes;

    explicit Sizes(const Map& map)
        : means(map.speeds.size() * map.directions.count() * map.sources.size()),
          fluctuations(map.fluctuation_directions.count()),
          fluctuation(map.sources.size() * map.samples * Map::components),
          bytes(24 * std::uint64_t{means} + 4 * std::uint64_t{fluctuations} * fluctuation) {}
};

}  // namespace

std::vector<std::uint8_t> encode_raw(const Map& map, const Tables& tables) {
    const Sizes sizes(map);
    if (tables.mean.size() != sizes.means || tables.fluctuation.size() != sizes.fluctuations)
        throw Error(FRM_ERROR_INTERNAL, "raw tables: their sizes do not match the map");
    Bytes raw;
    raw.reserve(sizes.bytes);
    ByteWriter<Bytes> w(raw);
    for (const SourceForce& f : tables.mean) {
        w.vec3(f.pressure);
        w.vec3(f.friction);
    }
    for (const Fluctuation& f : tables.fluctuation) {
        if (f.size() != sizes.fluctuation)
            throw Error(FRM_ERROR_INTERNAL, "raw tables: a fluctuation has another size");
        for (const float v : f) w.f32(v);
    }
    Bytes file;
    ByteWriter<Bytes> head(file);
    head.bytes(raw_magic, sizeof raw_magic);
    head.u32(raw_format_version);
    head.u32(0);
    head.u64(identity(map));
    head.u64(raw.size());
    const Bytes stored = compress(raw, 19);
    head.bytes(stored.data(), stored.size());
    return file;
}

Tables decode_raw(const std::uint8_t* data, std::size_t size, const Map& map) {
    ByteReader head(data, size, "raw tables");
    if (size < header_bytes || std::memcmp(head.take(8), raw_magic, 8) != 0)
        corrupt("this is not a .frmraw file (its first bytes are not the format's)");
    if (const std::uint32_t version = head.u32(); version != raw_format_version)
        throw Error(FRM_ERROR_VERSION, "raw tables: format version %u; this program reads version %u", version,
                    raw_format_version);
    if (head.u32() != 0) corrupt("the header's reserved field is not 0");
    if (head.u64() != identity(map))
        throw Error(FRM_ERROR_ARGUMENT,
                    "raw tables: they are of another map (another object, or other directions, speeds or samples)");
    const Sizes sizes(map);
    const std::uint64_t bytes = head.u64();
    const std::size_t stored = head.left();
    const std::uint8_t* frame = head.take(stored);
    if (bytes != sizes.bytes || bytes > max_raw_bytes || ZSTD_getFrameContentSize(frame, stored) != bytes)
        corrupt("their size does not match the map");
    Bytes raw(static_cast<std::size_t>(bytes));
    const std::size_t got = ZSTD_decompress(raw.data(), raw.size(), frame, stored);
    if (ZSTD_isError(got)) corrupt(ZSTD_getErrorName(got));
    if (got != raw.size()) corrupt("they decompress to another size");

    ByteReader r(raw.data(), raw.size(), "raw tables");
    Tables tables;
    tables.mean.resize(sizes.means);
    for (SourceForce& f : tables.mean) {
        f.pressure = r.vec3();
        f.friction = r.vec3();
    }
    tables.fluctuation.resize(sizes.fluctuations);
    for (Fluctuation& f : tables.fluctuation) {
        f.resize(sizes.fluctuation);
        for (float& v : f) v = r.f32();
    }
    r.end();
    return tables;
}

}  // namespace frm::bake
