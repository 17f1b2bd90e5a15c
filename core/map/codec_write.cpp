#include <zstd.h>

#include <cmath>

#include "core/map/bytes.h"
#include "core/map/codec.h"
#include "core/math/hash.h"

namespace frm {
namespace {

using Bytes = std::vector<std::uint8_t>;

void append_chunk(Bytes& file, const char (&type)[5], std::uint32_t index, const Bytes& raw) {
    const Bytes stored = compress(raw, 19);
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
    for (const float v : {f.direction_error_rms, f.direction_error_worst, f.uncertainty}) w.f32(v);
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
    w.u32(map.fluctuation_directions.frequency());
    return raw;
}

Bytes speeds_chunk(const Map& map) {
    Bytes raw;
    ByteWriter<Bytes> w(raw);
    w.u32(static_cast<std::uint32_t>(map.speeds.size()));
    for (const float u : map.speeds) w.f32(u);
    return raw;
}

void write_planes(ByteWriter<Bytes>& w, const std::vector<std::uint16_t>& codes) {
    for (const std::uint16_t v : codes) w.u8(static_cast<std::uint8_t>(v));
    for (const std::uint16_t v : codes) w.u8(static_cast<std::uint8_t>(v >> 8));
}

// Differences from what the neighbouring directions lead one to expect.
Bytes means_chunk(const Map& map, std::size_t speed) {
    Bytes raw;
    ByteWriter<Bytes> w(raw);
    const std::size_t sources = map.sources.size(), count = map.directions.count();
    const SourceForce* mean = map.mean.data() + speed * count * sources;
    const std::array<float, 2> step = map.mean_step[speed];
    w.f32(step[0]);
    w.f32(step[1]);
    if (!(step[0] > 0 && step[1] > 0)) {
        for (std::size_t i = 0; i < count * sources; ++i) {
            w.vec3(mean[i].pressure);
            w.vec3(mean[i].friction);
        }
        return raw;
    }
    std::vector<Neighbours> known;
    for (std::uint32_t d = 0; d < count; ++d) known.push_back(map.directions.earlier_neighbours(d));
    std::vector<std::int16_t> values(count);
    std::vector<std::uint16_t> codes;
    codes.reserve(count * sources * Map::components);
    for (std::size_t l = 0; l < sources; ++l) {
        for (int c = 0; c < 6; ++c) {
            for (std::size_t d = 0; d < count; ++d) {
                const SourceForce& f = mean[d * sources + l];
                values[d] = static_cast<std::int16_t>(
                    std::lround(c < 3 ? f.pressure[c] / step[0] : f.friction[c - 3] / step[1]));
                codes.push_back(format::fold(
                    static_cast<std::uint16_t>(values[d] - format::expected_mean(values.data(), known[d]))));
            }
        }
    }
    write_planes(w, codes);
    return raw;
}

Bytes spin_chunk(const Map& map) {
    Bytes raw;
    ByteWriter<Bytes> w(raw);
    w.f32(map.spin.rate);
    w.vec3(map.spin.centre);
    for (const SourceForce& f : map.spin.force) {
        w.vec3(f.pressure);
        w.vec3(f.friction);
    }
    return raw;
}

Bytes added_mass_chunk(const Map& map) {
    Bytes raw;
    ByteWriter<Bytes> w(raw);
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = i; j < 6; ++j) w.f64(map.added_mass[6 * i + j]);
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
                folded.push_back(format::fold(static_cast<std::uint16_t>(now - before)));
                before = now;
            }
        }
    }
    write_planes(w, folded);
    return raw;
}

}  // namespace

std::vector<std::uint8_t> compress(const std::vector<std::uint8_t>& raw, int level) {
    std::vector<std::uint8_t> out(ZSTD_compressBound(raw.size()));
    ZSTD_CCtx* context = ZSTD_createCCtx();
    if (!context) throw std::bad_alloc();
    ZSTD_CCtx_setParameter(context, ZSTD_c_compressionLevel, level);
    ZSTD_CCtx_setParameter(context, ZSTD_c_checksumFlag, 1);
    const std::size_t size = ZSTD_compress2(context, out.data(), out.size(), raw.data(), raw.size());
    ZSTD_freeCCtx(context);
    if (ZSTD_isError(size)) throw Error(FRM_ERROR_INTERNAL, "zstd: %s", ZSTD_getErrorName(size));
    out.resize(size);
    return out;
}

std::vector<std::uint8_t> encode_map(const Map& map) {
    Bytes body;
    std::uint32_t chunks = 0;
    const auto append = [&](const char(&type)[5], std::uint32_t index, const Bytes& raw) {
        append_chunk(body, type, index, raw);
        ++chunks;
    };
    append("FACT", 0, facts_chunk(map));
    append("GEOM", 0, geometry_chunk(map));
    append("REGN", 0, regions_chunk(map));
    append("DIRS", 0, directions_chunk(map));
    append("SPED", 0, speeds_chunk(map));
    for (std::uint32_t k = 0; k < map.speeds.size(); ++k) append("MEAN", k, means_chunk(map, k));
    for (std::uint32_t d = 0; d < map.fluctuation_directions.count(); ++d) append("FLUC", d, fluctuation_chunk(map, d));
    if (map.spin.rate > 0) append("SPIN", 0, spin_chunk(map));
    if (map.has_added_mass) append("MASS", 0, added_mass_chunk(map));
    append("PROV", 0, Bytes(map.provenance.begin(), map.provenance.end()));

    Bytes file;
    ByteWriter<Bytes> w(file);
    w.bytes(format::magic, sizeof format::magic);
    w.u32(map_format_version);
    w.u32(0);
    w.u64(fnv1a(body.data(), body.size()));
    w.u64(format::header_bytes + body.size());
    w.u32(chunks);
    w.u32(0);
    w.bytes(body.data(), body.size());
    return file;
}

}  // namespace frm
