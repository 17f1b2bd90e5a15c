#include <zstd.h>

#include "core/map/bytes.h"
#include "core/map/codec.h"
#include "core/math/hash.h"

namespace frm {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes compress(const Bytes& raw) {
    ZSTD_CCtx* context = ZSTD_createCCtx();
    if (!context) throw std::bad_alloc();
    Bytes out(ZSTD_compressBound(raw.size()));
    ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, 19);
    ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
    ZSTD_CCtx_setParameter(context, ZSTD_c_contentSizeFlag, 1);
    const std::size_t size = ZSTD_compress2(context, out.data(), out.size(), raw.data(), raw.size());
    ZSTD_freeCCtx(context);
    if (ZSTD_isError(size)) throw Error(FRM_ERROR_INTERNAL, "zstd: %s", ZSTD_getErrorName(size));
    out.resize(size);
    return out;
}

void append_chunk(Bytes& file, const char (&type)[5], std::uint32_t index, const Bytes& raw) {
    const Bytes stored = compress(raw);
    ByteWriter<Bytes> w(file);
    w.bytes(type, 4);
    w.u32(index);
    w.u64(raw.size());
    w.u64(stored.size());
    w.u64(0);
    w.bytes(stored.data(), stored.size());
}

Bytes facts_chunk(const Map& map) {
    Bytes raw;
    ByteWriter<Bytes> w(raw);
    const MapFacts& f = map.facts;
    for (const float v : {f.base_speed, f.period, f.density, f.viscosity, f.reference_length, f.reynolds,
                          f.reynolds_solved, f.quantisation_error})
        w.f32(v);
    w.u32(map.samples);
    return raw;
}

Bytes geometry_chunk(const Map& map) {
    Bytes raw;
    ByteWriter<Bytes> w(raw);
    w.u32(static_cast<std::uint32_t>(map.vertices.size()));
    w.u32(static_cast<std::uint32_t>(map.triangles.size()));
    for (const Vec3f& v : map.vertices) w.vec3(v);
    for (const auto& t : map.triangles)
        for (const std::uint32_t i : t) w.u32(i);
    return raw;
}

Bytes regions_chunk(const Map& map) {
    Bytes raw;
    ByteWriter<Bytes> w(raw);
    w.u32(map.source_count());
    for (const std::uint32_t begin : map.region_begin) w.u32(begin);
    for (const Source& s : map.sources) {
        w.vec3(s.position);
        w.vec3(s.normal);
        w.f32(s.area);
    }
    return raw;
}

Bytes directions_chunk(const Map& map) {
    Bytes raw;
    ByteWriter<Bytes> w(raw);
    w.u32(map.directions.frequency());
    w.u32(map.directions.count());
    for (std::uint32_t i = 0; i < map.directions.count(); ++i) w.vec3(Vec3f(map.directions.direction(i)));
    return raw;
}

Bytes means_chunk(const Map& map) {
    Bytes raw;
    ByteWriter<Bytes> w(raw);
    for (const SourceForce& f : map.mean) {
        w.vec3(f.pressure);
        w.vec3(f.friction);
    }
    return raw;
}

// Differences in time, folded so that small ones of either sign are small numbers, low bytes before high bytes: what
// is smooth in time becomes runs of zeros for zstd.
Bytes fluctuation_chunk(const Map& map, std::uint32_t direction) {
    Bytes raw;
    ByteWriter<Bytes> w(raw);
    w.f32(map.step[direction]);
    const std::size_t sources = map.sources.size(), samples = map.samples, width = Map::components;
    const std::size_t count = sources * samples * width;
    const std::int16_t* values = map.fluctuation.data() + direction * count;
    std::vector<std::uint16_t> folded;
    folded.reserve(count);
    for (std::size_t l = 0; l < sources; ++l) {
        for (std::size_t c = 0; c < width; ++c) {
            std::uint16_t before = 0;
            for (std::size_t s = 0; s < samples; ++s) {
                const auto now = static_cast<std::uint16_t>(values[(l * samples + s) * width + c]);
                const auto difference = static_cast<std::uint16_t>(now - before);
                const auto sign = static_cast<std::uint16_t>(difference & 0x8000u ? 0xFFFFu : 0u);
                folded.push_back(static_cast<std::uint16_t>((difference << 1) ^ sign));
                before = now;
            }
        }
    }
    for (const std::uint16_t v : folded) w.u8(static_cast<std::uint8_t>(v));
    for (const std::uint16_t v : folded) w.u8(static_cast<std::uint8_t>(v >> 8));
    return raw;
}

}  // namespace

std::vector<std::uint8_t> encode_map(const Map& map) {
    Bytes body;
    append_chunk(body, "FACT", 0, facts_chunk(map));
    append_chunk(body, "GEOM", 0, geometry_chunk(map));
    append_chunk(body, "REGN", 0, regions_chunk(map));
    append_chunk(body, "DIRS", 0, directions_chunk(map));
    append_chunk(body, "MEAN", 0, means_chunk(map));
    for (std::uint32_t d = 0; d < map.directions.count(); ++d) append_chunk(body, "FLUC", d, fluctuation_chunk(map, d));
    append_chunk(body, "PROV", 0, Bytes(map.provenance.begin(), map.provenance.end()));

    Bytes file;
    ByteWriter<Bytes> w(file);
    w.bytes(format::magic, sizeof format::magic);
    w.u32(map_format_version);
    w.u32(0);
    w.u64(fnv1a(body.data(), body.size()));
    w.u64(format::header_bytes + body.size());
    w.u32(6 + map.directions.count());
    w.u32(0);
    w.bytes(body.data(), body.size());
    return file;
}

}  // namespace frm
