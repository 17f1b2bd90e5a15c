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
        version_ = reader_.u32();
        if (version_ < 1 || version_ > map_format_version)
            throw Error(FRM_ERROR_VERSION, "map: format version %u; this library reads versions 1 to %u", version_,
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
        else if (is("SPED") && version_ >= 2)
            once(c, speeds_), speeds(c);
        else if (is("MEAN") && version_ == 1)
            once(c, means_), means_of_version_1(c);
        else if (is("MEAN"))
            means(c);
        else if (is("FLUC"))
            fluctuation(c);
        else if (is("SPIN") && version_ >= 2)
            once(c, spin_), spin(c);
        else if (is("MASS") && version_ >= 2)
            once(c, added_mass_), added_mass(c);
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
        ByteReader r = open(c, version_ == 1 ? 36 : 48);
        MapFacts& f = map_.facts;
        for (float* v : {&f.base_speed, &f.period, &f.density, &f.viscosity, &f.reference_length, &f.reynolds,
                         &f.reynolds_solved, &f.quantisation_error})
            *v = r.f32();
        map_.samples = r.u32();
        if (map_.samples == 0 || map_.samples > Map::max_samples) corrupt(c, "the number of samples is out of range");
        if (version_ == 1)
            map_.speeds.assign(1, f.base_speed);
        else
            for (float* v : {&f.direction_error_rms, &f.direction_error_worst, &f.uncertainty}) *v = r.f32();
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

    DirectionSet frequency(const Chunk& c, std::uint32_t n) {
        if (n == 0 || n > DirectionSet::max_frequency) corrupt(c, "the frequency is out of range");
        return DirectionSet(n);
    }

    void directions(const Chunk& c) {
        if (version_ == 1) {
            if (c.raw_size < 8) corrupt(c, "is too short");
            ByteReader r = open(c, c.raw_size);
            map_.directions = map_.fluctuation_directions = frequency(c, r.u32());
            directions_of_version_1(c, r);
        } else {
            ByteReader r = open(c, 8);
            map_.directions = frequency(c, r.u32());
            map_.fluctuation_directions = frequency(c, r.u32());
        }
        map_.step.assign(map_.fluctuation_directions.count(), 0.0f);
        seen_.assign(map_.fluctuation_directions.count(), 0);
    }

    /// Version 1 has one set and its vectors, for convenience.
    void directions_of_version_1(const Chunk& c, ByteReader& r) {
        const DirectionSet& set = map_.directions;
        if (r.u32() != set.count()) corrupt(c, "the number of directions does not match the frequency");
        if (c.raw_size != 8 + std::uint64_t{12} * set.count()) corrupt(c, "its size does not match its count");
        for (std::uint32_t i = 0; i < set.count(); ++i) {
            const Vec3f stored = r.vec3();
            const Vec3f expected(set.direction(i));
            const Vec3f d = stored - expected;
            if (!(dot(d, d) < 1e-10f)) corrupt(c, "a direction is not where the set has it");
        }
    }

    void speeds(const Chunk& c) {
        if (c.raw_size < 8 || c.raw_size > 4 + 4 * Map::max_speeds) corrupt(c, "the number of speeds is out of range");
        ByteReader r = open(c, c.raw_size);
        const std::uint64_t count = r.u32();
        if (c.raw_size != 4 + 4 * count) corrupt(c, "its size does not match its count");
        map_.speeds.resize(count);
        for (float& u : map_.speeds) u = r.f32();
        seen_speed_.assign(count, 0);
    }

    void read_plain(ByteReader& r, SourceForce* out, std::size_t count) {
        for (std::size_t i = 0; i < count; ++i) {
            out[i].pressure = r.vec3();
            out[i].friction = r.vec3();
        }
    }

    void means_of_version_1(const Chunk& c) {
        needs(c, regions_ && directions_, "comes before REGN and DIRS");
        const std::uint64_t cells = std::uint64_t{map_.directions.count()} * map_.sources.size();
        ByteReader r = open(c, cells * 24);
        map_.mean.resize(cells);
        map_.mean_step.assign(1, {0, 0});
        read_plain(r, map_.mean.data(), cells);
    }

    void means(const Chunk& c) {
        needs(c, regions_ && directions_ && speeds_, "comes before REGN, DIRS or SPED");
        if (c.index >= map_.speeds.size()) corrupt(c, "names a speed that is not there");
        if (seen_speed_[c.index]) corrupt(c, "comes twice");
        seen_speed_[c.index] = 1;
        const std::size_t sources = map_.sources.size(), count = map_.directions.count(), cells = count * sources;
        if (std::uint64_t{cells} * Map::components * map_.speeds.size() > Map::max_means)
            corrupt(c, "is one of a set that is too large");
        const std::uint64_t plain = 8 + 24 * std::uint64_t{cells}, coded = 8 + 12 * std::uint64_t{cells};
        ByteReader r = open(c, c.raw_size == plain ? plain : coded);
        if (map_.mean.empty()) {
            map_.mean.resize(map_.speeds.size() * cells);
            map_.mean_step.assign(map_.speeds.size(), {0, 0});
        }
        const float pressure = r.f32(), friction = r.f32();
        map_.mean_step[c.index] = {pressure, friction};
        SourceForce* out = map_.mean.data() + c.index * cells;
        if ((c.raw_size == plain) != (pressure == 0 && friction == 0)) corrupt(c, "its steps do not match its size");
        if (c.raw_size == plain) return read_plain(r, out, cells);

        if (known_.empty())
            for (std::uint32_t d = 0; d < count; ++d) known_.push_back(map_.directions.earlier_neighbours(d));
        const std::uint8_t* low = r.take(cells * Map::components);
        const std::uint8_t* high = r.take(cells * Map::components);
        std::pmr::vector<std::int16_t> values(count, raw_.get_allocator());
        std::size_t at = 0;
        for (std::size_t l = 0; l < sources; ++l) {
            for (int k = 0; k < 6; ++k) {
                for (std::size_t d = 0; d < count; ++d, ++at) {
                    const auto code = static_cast<std::uint16_t>(low[at] | high[at] << 8);
                    values[d] = static_cast<std::int16_t>(static_cast<std::uint16_t>(
                        format::expected_mean(values.data(), known_[d]) + format::unfold(code)));
                    SourceForce& f = out[d * sources + l];
                    if (k < 3)
                        f.pressure[k] = pressure * static_cast<float>(values[d]);
                    else
                        f.friction[k - 3] = friction * static_cast<float>(values[d]);
                }
            }
        }
    }

    void spin(const Chunk& c) {
        needs(c, regions_, "comes before REGN");
        const std::size_t count = DirectionSet(1).count() * map_.sources.size();
        ByteReader r = open(c, 16 + 24 * std::uint64_t{count});
        map_.spin.rate = r.f32();
        map_.spin.centre = r.vec3();
        if (!(map_.spin.rate > 0)) corrupt(c, "the rate is not a positive number");
        map_.spin.force.resize(count);
        read_plain(r, map_.spin.force.data(), count);
    }

    void added_mass(const Chunk& c) {
        ByteReader r = open(c, 21 * 8);
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t j = i; j < 6; ++j) map_.added_mass[6 * i + j] = map_.added_mass[6 * j + i] = r.f64();
        map_.has_added_mass = true;
    }

    void fluctuation(const Chunk& c) {
        needs(c, facts_ && geometry_ && regions_ && directions_ && !map_.mean.empty(),
              "comes before FACT, GEOM, REGN, DIRS or MEAN");
        const std::uint32_t directions = map_.fluctuation_directions.count();
        if (c.index >= directions) corrupt(c, "names a direction that is not there");
        if (seen_[c.index]) corrupt(c, "comes twice");
        const std::size_t sources = map_.sources.size(), samples = map_.samples, width = Map::components;
        const std::size_t count = sources * samples * width;
        if (std::uint64_t{count} * directions > Map::max_fluctuations) corrupt(c, "is one of a set that is too large");
        ByteReader r = open(c, 4 + 2 * std::uint64_t{count});
        if (map_.fluctuation.empty()) map_.fluctuation.resize(directions * count);
        map_.step[c.index] = r.f32();
        const std::uint8_t* low = r.take(count);
        const std::uint8_t* high = r.take(count);
        std::int16_t* values = map_.fluctuation.data() + c.index * count;
        std::size_t at = 0;
        for (std::size_t l = 0; l < sources; ++l) {
            for (std::size_t k = 0; k < width; ++k) {
                std::uint16_t before = 0;
                for (std::size_t s = 0; s < samples; ++s, ++at) {
                    const auto code = static_cast<std::uint16_t>(low[at] | high[at] << 8);
                    before = static_cast<std::uint16_t>(before + format::unfold(code));
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
        if (version_ == 1) {
            have(means_, "MEAN");
        } else {
            have(speeds_, "SPED");
            for (std::uint32_t k = 0; k < map_.speeds.size(); ++k)
                if (!seen_speed_[k]) throw Error(FRM_ERROR_CORRUPT, "map: chunk MEAN %u is missing", k);
        }
        for (std::uint32_t d = 0; d < map_.fluctuation_directions.count(); ++d)
            if (!seen_[d]) throw Error(FRM_ERROR_CORRUPT, "map: chunk FLUC %u is missing", d);
        map_.complete();
        map_.format_version = version_;
    }

    Map& map_;
    std::uint32_t version_ = 0;
    std::pmr::vector<std::uint8_t> raw_;
    std::vector<std::uint8_t> seen_, seen_speed_;  ///< of the directions of FLUC, of the speeds of MEAN
    std::vector<Neighbours> known_;
    ByteReader reader_;
    bool facts_ = false, geometry_ = false, regions_ = false, directions_ = false, means_ = false, provenance_ = false;
    bool speeds_ = false, spin_ = false, added_mass_ = false;
};

}  // namespace

void decode_map(const std::uint8_t* data, std::size_t size, Map& map) {
    Decoder(data, size, map).run();
    map.file.assign(data, data + size);
}

}  // namespace frm
