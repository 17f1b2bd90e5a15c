#include <cerrno>
#include <cstdio>
#include <cstring>

#include "core/api/objects.h"
#include "core/file.h"
#include "core/map/codec.h"

namespace frm::api {

std::shared_ptr<const Map> read_map(Context& context, const std::uint8_t* data, std::size_t size) {
    auto map = context.make<Map>(context.memory());
    decode_map(data, size, *map);
    return map;
}

namespace {

std::pmr::vector<std::uint8_t> read_file(Context& context, const char* path) {
    std::FILE* file = open_file(path, "rb");
    if (!file) throw Error(FRM_ERROR_FILE, "%s: %s", path, std::strerror(errno));
    std::pmr::vector<std::uint8_t> bytes(context.memory());
    std::uint8_t block[1 << 16];
    std::size_t got;
    bool bad = false;
    try {
        while ((got = std::fread(block, 1, sizeof block, file)) > 0) bytes.insert(bytes.end(), block, block + got);
        bad = std::ferror(file) != 0;
    } catch (...) {
        std::fclose(file);
        throw;
    }
    std::fclose(file);
    if (bad) throw Error(FRM_ERROR_FILE, "%s: %s", path, std::strerror(errno));
    return bytes;
}

frm_map open(Context& context, const std::uint8_t* data, std::size_t size) {
    auto map = read_map(context, data, size);
    const frm_map handle = context.add(Kind::map, context.make<MapObject>(map));
    if (map->facts.reynolds_solved < 0.999f * map->facts.reynolds)
        context.log(FRM_LOG_INFO, "map: baked at Reynolds number %g, solved at %g",
                    static_cast<double>(map->facts.reynolds), static_cast<double>(map->facts.reynolds_solved));
    return handle;
}

}  // namespace
}  // namespace frm::api

using namespace frm;
using namespace frm::api;

frm_status FRM_CALL frm_map_open_file(frm_context context, const char* path, frm_map* map) {
    return with_context(context, [&](Context& c) {
        require_pointer(path, "path");
        require_pointer(map, "map");
        const auto bytes = read_file(c, path);
        try {
            *map = open(c, bytes.data(), bytes.size());
        } catch (const Error& error) {
            throw Error(error.status(), "%s: %s", path, error.text());
        }
    });
}

frm_status FRM_CALL frm_map_open_memory(frm_context context, const void* data, uint64_t size, frm_map* map) {
    return with_context(context, [&](Context& c) {
        require_pointer(data, "data");
        require_pointer(map, "map");
        *map = open(c, static_cast<const std::uint8_t*>(data), static_cast<std::size_t>(size));
    });
}

frm_status FRM_CALL frm_map_close(frm_map map) {
    return with<MapObject>(map, [&](Context& c, MapObject& object) {
        if (object.map.use_count() > 1) throw Error(FRM_ERROR_STATE, "a body or a replay still uses this map");
        c.remove(map);
    });
}

frm_status FRM_CALL frm_map_get_info(frm_map map, frm_map_info* info) {
    return with<MapObject>(map, [&](Context& c, MapObject& object) {
        require_out(info, "info");
        const Map& m = *object.map;
        frm_map_info out{};
        out.format_version = m.format_version;
        out.file_bytes = m.file.size();
        out.content_hash = m.content_hash;
        out.sources = m.source_count();
        out.directions = m.directions.count();
        out.samples = m.samples;
        out.triangles = static_cast<std::uint32_t>(m.triangles.size());
        out.period = m.facts.period;
        out.base_speed = m.facts.base_speed;
        out.density = m.facts.density;
        out.viscosity = m.facts.viscosity;
        out.reynolds = m.facts.reynolds;
        out.reynolds_solved = m.facts.reynolds_solved;
        out.reference_length = m.facts.reference_length;
        out.quantisation_error = m.facts.quantisation_error;
        out.area = static_cast<float>(m.shape.area);
        out.volume = static_cast<float>(m.shape.volume);
        out.centroid = c.axes().body_out(Vec3f(m.shape.centroid));
        const frm_vec3 low = c.axes().body_out(m.shape.low), high = c.axes().body_out(m.shape.high);
        out.bounds_low = {std::fmin(low.x, high.x), std::fmin(low.y, high.y), std::fmin(low.z, high.z)};
        out.bounds_high = {std::fmax(low.x, high.x), std::fmax(low.y, high.y), std::fmax(low.z, high.z)};
        out.fluctuation_directions = m.fluctuation_directions.count();
        out.speeds = static_cast<std::uint32_t>(m.speeds.size());
        out.has_spin = m.spin.rate > 0;
        out.has_added_mass = m.has_added_mass;
        out.direction_error_rms = m.facts.direction_error_rms;
        out.direction_error_worst = m.facts.direction_error_worst;
        out.uncertainty = m.facts.uncertainty;
        write_struct(info, out);
    });
}

frm_status FRM_CALL frm_map_get_added_mass(frm_map map, float density, float scale, double* matrix) {
    return with<MapObject>(map, [&](Context& c, MapObject& object) {
        require_pointer(matrix, "matrix");
        require_range(static_cast<double>(density), 1e-3f, 1e5, "density");
        require_range(static_cast<double>(scale), 1e-3f, 1e3, "scale");
        const Map& m = *object.map;
        if (!m.has_added_mass) throw Error(FRM_ERROR_STATE, "the map was made without added mass");
        // Each of the host's six axes is one of the map's, or its opposite.
        std::size_t from[6];
        double sign[6];
        for (std::size_t i = 0; i < 6; ++i) {
            Vec3f unit;
            unit[static_cast<int>(i % 3)] = 1;
            const frm_vec3 v = i < 3 ? c.axes().body_out(unit) : c.axes().body_axial_out(unit);
            const float part[3] = {v.x, v.y, v.z};
            for (std::size_t k = 0; k < 3; ++k) {
                if (part[k] == 0) continue;
                from[i - i % 3 + k] = i;
                sign[i - i % 3 + k] = static_cast<double>(part[k]);
            }
        }
        const double s = static_cast<double>(scale),
                     unit = static_cast<double>(density) / static_cast<double>(m.facts.density);
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t j = 0; j < 6; ++j) {
                double factor = unit * s * s * s;
                if (i >= 3) factor *= s;
                if (j >= 3) factor *= s;
                matrix[6 * i + j] = sign[i] * sign[j] * factor * m.added_mass[6 * from[i] + from[j]];
            }
    });
}

frm_status FRM_CALL frm_map_get_source(frm_map map, uint32_t index, frm_map_source* source) {
    return with<MapObject>(map, [&](Context& c, MapObject& object) {
        require_out(source, "source");
        if (index >= object.map->source_count())
            throw Error(FRM_ERROR_ARGUMENT, "index = %u; the map has %u sources", index, object.map->source_count());
        const Source& s = object.map->sources[index];
        frm_map_source out{};
        out.area = s.area;
        out.position = c.axes().body_out(s.position);
        out.normal = c.axes().body_out(s.normal);
        write_struct(source, out);
    });
}

frm_status FRM_CALL frm_map_get_provenance(frm_map map, char* text, uint64_t capacity, uint64_t* size) {
    return with<MapObject>(map, [&](Context&, MapObject& object) {
        const auto& provenance = object.map->provenance;
        write_text(provenance.data(), provenance.size(), text, capacity, size);
    });
}
