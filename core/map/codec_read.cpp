#include <zstd.h>

#include <cstring>

#include "core/map/bytes.h"
#include "core/map/codec.h"
#include "core/math/hash.h"

namespace frm {
namespace {

struct Chunk {
    char type[5] = {};
    std::uint32_t index = 0;
    std::uint64_t raw_size = 0;
    const std::uint8_t* stored = nullptr;
    std::size_t stored_size = 0;
};

[[noreturn]] void corrupt(const Chunk& chunk, const char* what) {
    throw Error(FRM_ERROR_CORRUPT, "map: chunk %s %u: %s", chunk.type, chunk.index, what);
}

/// A direction's fluctuations at the largest sizes that the format allows are the longest chunk.
constexpr std::uint64_t max_raw_size = std::uint64_t{1} << 28;
/// Of all directions together: 4 GiB in memory.
constexpr std::uint64_t max_values = std::uint64_t{1} << 31;

class Decoder {
public:
    Decoder(const std::uint8_t* data, std::size_t size, Map& map)
        : map_(map), raw_(map.file.get_allocator()), reader_(data, size, "map") {}

    void run() {
        const std::uint32_t chunks = header();
        for (std::uint32_t i = 0; i < chunks; ++i) chunk();
        reader_.end();
        finish();
    }

private:
    std::uint32_t header() {
        const std::uint64_t file_size = reader_.left();
        if (file_size < format::header_bytes || std::memcmp(reader_.take(8), format::magic, 8) != 0)
            throw Error(FRM_ERROR_CORRUPT, "map: this is not a .frm file (its first bytes are not the format's)");
        const std::uint32_t version = reader_.u32();
        if (version != map_format_version)
            throw Error(FRM_ERROR_VERSION, "map: format version %u; this library reads version %u", version,
                        map_format_version);
        if (reader_.u32() != 0)
            throw Error(FRM_ERROR_VERSION, "map: the header has flags that this library does not know");
        map_.content_hash = reader_.u64();
        if (reader_.u64() != file_size) throw Error(FRM_ERROR_CORRUPT, "map: the file is cut off or has grown");
        const std::uint32_t chunks = reader_.u32();
        if (reader_.u32() != 0) throw Error(FRM_ERROR_CORRUPT, "map: the header's reserved field is not 0");
        const std::uint8_t* body = reader_.take(0);
        if (fnv1a(body, reader_.left()) != map_.content_hash)
            throw Error(FRM_ERROR_CORRUPT, "map: the content hash does not match: the file is damaged");
        return chunks;
    }

    void chunk() {
        Chunk c;
        std::memcpy(c.type, reader_.take(4), 4);
        for (int i = 0; i < 4; ++i)
            if (c.type[i] < 32 || c.type[i] > 126) throw Error(FRM_ERROR_CORRUPT, "map: a chunk's type is not text");
        c.index = reader_.u32();
        c.raw_size = reader_.u64();
        const std::uint64_t stored = reader_.u64();
        if (reader_.u64() != 0) corrupt(c, "its reserved field is not 0");
        if (stored > reader_.left()) corrupt(c, "is longer than the file");
        c.stored_size = static_cast<std::size_t>(stored);
        c.stored = reader_.take(c.stored_size);

        const auto is = [&](const char* type) { return std::memcmp(c.type, type, 4) == 0; };
        if (is("FACT"))
            once(c, facts_), facts(c);
        else if (is("GEOM"))
            once(c, geometry_), geometry(c);
        else if (is("REGN"))
            once(c, regions_), regions(c);
        else if (is("DIRS"))
            once(c, directions_), directions(c);
        else if (is("MEAN"))
            once(c, means_), means(c);
        else if (is("FLUC"))
            fluctuation(c);
        else if (is("PROV"))
            once(c, provenance_), provenance(c);
        // Any other type comes from a later version that older readers may ignore.
    }

    void once(const Chunk& c, bool& seen) {
        if (seen) corrupt(c, "comes twice");
        seen = true;
    }

    /// Decompresses into raw_. `expected` is the size that the counts read so far ask for, so that no chunk can claim
    /// more.
    ByteReader open(const Chunk& c, std::uint64_t expected) {
        if (c.raw_size != expected) corrupt(c, "its size does not match its contents");
        if (c.raw_size > max_raw_size) corrupt(c, "is too large");
        if (ZSTD_getFrameContentSize(c.stored, c.stored_size) != c.raw_size)
            corrupt(c, "its compressed frame has another size");
        raw_.resize(static_cast<std::size_t>(c.raw_size));
        const std::size_t size = ZSTD_decompress(raw_.data(), raw_.size(), c.stored, c.stored_size);
        if (ZSTD_isError(size)) corrupt(c, ZSTD_getErrorName(size));
        if (size != raw_.size()) corrupt(c, "decompresses to another size");
        return ByteReader(raw_.data(), raw_.size(), c.type);
    }

    void needs(const Chunk& c, bool before, const char* what) {
        if (!before) corrupt(c, what);
    }

    void facts(const Chunk& c) {
        ByteReader r = open(c, 9 * 4);
        MapFacts& f = map_.facts;
        for (float* v : {&f.base_speed, &f.period, &f.density, &f.viscosity, &f.reference_length, &f.reynolds,
                         &f.reynolds_solved, &f.quantisation_error})
            *v = r.f32();
        map_.samples = r.u32();
        if (map_.samples == 0 || map_.samples > Map::max_samples) corrupt(c, "the number of samples is out of range");
    }

    void geometry(const Chunk& c) {
        if (c.raw_size < 8) corrupt(c, "is too short");
        ByteReader r = open(c, c.raw_size);
        const std::uint64_t vertices = r.u32(), triangles = r.u32();
        if (vertices > 3u * Map::max_triangles || triangles > Map::max_triangles) corrupt(c, "has too many triangles");
        if (c.raw_size != 8 + 12 * (vertices + triangles)) corrupt(c, "its size does not match its counts");
        map_.vertices.resize(vertices);
        for (Vec3f& v : map_.vertices) v = r.vec3();
        map_.triangles.resize(triangles);
        for (auto& t : map_.triangles)
            for (std::uint32_t& i : t) i = r.u32();
    }

    void regions(const Chunk& c) {
        if (c.raw_size < 8) corrupt(c, "is too short");
        ByteReader r = open(c, c.raw_size);
        const std::uint64_t sources = r.u32();
        if (sources == 0 || sources > Map::max_sources) corrupt(c, "the number of sources is out of range");
        if (c.raw_size != 4 + 4 * (sources + 1) + 28 * sources) corrupt(c, "its size does not match its count");
        map_.region_begin.resize(sources + 1);
        for (std::uint32_t& begin : map_.region_begin) begin = r.u32();
        map_.sources.resize(sources);
        for (Source& s : map_.sources) {
            s.position = r.vec3();
            s.normal = r.vec3();
            s.area = r.f32();
        }
    }

    void directions(const Chunk& c) {
        if (c.raw_size < 8) corrupt(c, "is too short");
        ByteReader r = open(c, c.raw_size);
        const std::uint32_t frequency = r.u32(), count = r.u32();
        if (frequency == 0 || frequency > DirectionSet::max_frequency) corrupt(c, "the frequency is out of range");
        const DirectionSet set(frequency);
        if (count != set.count()) corrupt(c, "the number of directions does not match the frequency");
        if (c.raw_size != 8 + std::uint64_t{12} * count) corrupt(c, "its size does not match its count");
        for (std::uint32_t i = 0; i < count; ++i) {
            const Vec3f stored = r.vec3();
            const Vec3f expected(set.direction(i));
            const Vec3f d = stored - expected;
            if (!(dot(d, d) < 1e-10f)) corrupt(c, "a direction is not where the set has it");
        }
        map_.directions = set;
        map_.step.assign(count, 0.0f);
        seen_.assign(count, 0);
    }

    void means(const Chunk& c) {
        needs(c, regions_ && directions_, "comes before REGN and DIRS");
        const std::uint64_t cells = std::uint64_t{map_.directions.count()} * map_.sources.size();
        ByteReader r = open(c, cells * 24);
        map_.mean.resize(cells);
        for (SourceForce& f : map_.mean) {
            f.pressure = r.vec3();
            f.friction = r.vec3();
        }
    }

    void fluctuation(const Chunk& c) {
        needs(c, facts_ && geometry_ && regions_ && directions_ && means_,
              "comes before FACT, GEOM, REGN, DIRS or MEAN");
        if (c.index >= map_.directions.count()) corrupt(c, "names a direction that is not there");
        if (seen_[c.index]) corrupt(c, "comes twice");
        const std::size_t sources = map_.sources.size(), samples = map_.samples, width = Map::components;
        const std::size_t count = sources * samples * width;
        if (std::uint64_t{count} * map_.directions.count() > max_values)
            corrupt(c, "is one of a set that is too large");
        ByteReader r = open(c, 4 + 2 * std::uint64_t{count});
        if (map_.fluctuation.empty()) map_.fluctuation.resize(map_.directions.count() * count);
        map_.step[c.index] = r.f32();
        const std::uint8_t* low = r.take(count);
        const std::uint8_t* high = r.take(count);
        std::int16_t* values = map_.fluctuation.data() + c.index * count;
        std::size_t at = 0;
        for (std::size_t l = 0; l < sources; ++l) {
            for (std::size_t k = 0; k < width; ++k) {
                std::uint16_t before = 0;
                for (std::size_t s = 0; s < samples; ++s, ++at) {
                    const auto folded = static_cast<std::uint16_t>(low[at] | high[at] << 8);
                    const auto sign = static_cast<std::uint16_t>(folded & 1u ? 0xFFFFu : 0u);
                    before = static_cast<std::uint16_t>(before + ((folded >> 1) ^ sign));
                    values[(l * samples + s) * width + k] = static_cast<std::int16_t>(before);
                }
            }
        }
        seen_[c.index] = 1;
    }

    void provenance(const Chunk& c) {
        if (c.raw_size > 1u << 20) corrupt(c, "is too large");
        ByteReader r = open(c, c.raw_size);
        const auto* text = reinterpret_cast<const char*>(r.take(raw_.size()));
        map_.provenance.assign(text, raw_.size());
    }

    void finish() {
        const auto have = [](bool seen, const char* type) {
            if (!seen) throw Error(FRM_ERROR_CORRUPT, "map: chunk %s is missing", type);
        };
        have(facts_, "FACT");
        have(geometry_, "GEOM");
        have(regions_, "REGN");
        have(directions_, "DIRS");
        have(means_, "MEAN");
        for (std::uint32_t d = 0; d < map_.directions.count(); ++d)
            if (!seen_[d]) throw Error(FRM_ERROR_CORRUPT, "map: chunk FLUC %u is missing", d);
        map_.complete();
    }

    Map& map_;
    std::pmr::vector<std::uint8_t> raw_;
    std::vector<std::uint8_t> seen_;
    ByteReader reader_;
    bool facts_ = false, geometry_ = false, regions_ = false, directions_ = false, means_ = false, provenance_ = false;
};

}  // namespace

void decode_map(const std::uint8_t* data, std::size_t size, Map& map) {
    Decoder(data, size, map).run();
    map.file.assign(data, data + size);
}

}  // namespace frm
