#include "core/map/map.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/math/logarithm.h"

namespace frm {

Map::Map(std::pmr::memory_resource* memory)
    : vertices(memory),
      triangles(memory),
      region_begin(memory),
      sources(memory),
      speeds(memory),
      mean(memory),
      mean_step(memory),
      step(memory),
      fluctuation(memory),
      spin(memory),
      provenance(memory),
      region_area(memory),
      clusters(memory),
      log_speed(memory),
      levels(memory),
      tables(memory),
      detail(memory),
      file(memory) {}

namespace {

bool finite(const Vec3f& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void require(bool condition, const char* what) {
    if (!condition) throw Error(FRM_ERROR_CORRUPT, "map: %s", what);
}

bool positive(float v) { return std::isfinite(v) && v > 0; }
bool share(float v) { return v >= 0 && v < 1; }

MapShape shape_of(const Map& map) {
    MapShape s;
    s.low = s.high = map.vertices.front();
    for (const Vec3f& v : map.vertices) {
        for (int i = 0; i < 3; ++i) {
            s.low[i] = std::min(s.low[i], v[i]);
            s.high[i] = std::max(s.high[i], v[i]);
        }
    }
    Vec3d moment;
    for (const auto& t : map.triangles) {
        const Vec3d a(map.vertices[t[0]]), b(map.vertices[t[1]]), c(map.vertices[t[2]]);
        s.area += 0.5 * length(cross(b - a, c - a));
        const double v = dot(a, cross(b, c)) / 6;
        s.volume += v;
        moment += (a + b + c) * (v / 4);
    }
    if (s.volume > 0) s.centroid = moment / s.volume;
    return s;
}

/// The force on the whole object, pressure and friction, sample by sample, of one direction's fluctuation.
void whole_fluctuation(const Map& map, std::uint32_t direction, Vec3f* out) {
    const std::size_t sources = map.sources.size();
    const std::int16_t* values = map.fluctuation.data() + direction * sources * map.samples * Map::components;
    for (std::uint32_t s = 0; s < map.samples; ++s) {
        std::int32_t sum[3] = {};
        for (std::size_t l = 0; l < sources; ++l) {
            const std::int16_t* v = values + (l * map.samples + s) * Map::components;
            for (int c = 0; c < 3; ++c) sum[c] += v[c] + v[c + 3];
        }
        out[s] = Vec3f(Vec3d(sum[0], sum[1], sum[2]) * static_cast<double>(map.step[direction]));
    }
}

double mean_product(const Vec3f* a, const Vec3f* b, std::uint32_t samples) {
    double sum = 0;
    for (std::uint32_t s = 0; s < samples; ++s) sum += dot(Vec3d(a[s]), Vec3d(b[s]));
    return sum / samples;
}

void measure_levels(Map& map) {
    const DirectionSet& set = map.fluctuation_directions;
    std::pmr::vector<Vec3f> whole(std::size_t{set.count()} * map.samples, map.levels.get_allocator());
    std::pmr::vector<double> square(set.count(), map.levels.get_allocator());
    const auto series = [&](std::uint32_t d) { return whole.data() + std::size_t{d} * map.samples; };
    double largest = 0;
    for (std::uint32_t d = 0; d < set.count(); ++d) {
        whole_fluctuation(map, d, series(d));
        square[d] = mean_product(series(d), series(d), map.samples);
        largest = std::max(largest, square[d]);
    }
    // In units of the largest, so that any force's square is a number of single precision.
    const double unit = largest > 0 ? 1 / largest : 0;
    map.levels.resize(set.faces());
    for (std::uint32_t f = 0; f < set.faces(); ++f) {
        const auto corner = set.corners(f);
        for (std::size_t k = 0; k < 3; ++k) {
            const Vec3f *b = series(corner[(k + 1) % 3]), *c = series(corner[(k + 2) % 3]);
            map.levels[f].rms[k] = static_cast<float>(std::sqrt(square[corner[k]] * unit));
            map.levels[f].product[k] = static_cast<float>(mean_product(b, c, map.samples) * unit);
        }
    }
}

}  // namespace

void Map::complete() {
    require(positive(facts.base_speed), "the base speed is not a positive number");
    require(positive(facts.period), "the period is not a positive number");
    require(positive(facts.density), "the density is not a positive number");
    require(positive(facts.viscosity), "the viscosity is not a positive number");
    require(positive(facts.reference_length), "the reference length is not a positive number");
    require(share(facts.quantisation_error), "the quantisation error is out of range");
    require(facts.direction_error_rms >= 0 && std::isfinite(facts.direction_error_rms) &&
                facts.direction_error_worst >= 0 && std::isfinite(facts.direction_error_worst),
            "the error of held-out directions is out of range");
    require(facts.uncertainty >= 0 && std::isfinite(facts.uncertainty), "the uncertainty is out of range");

    require(!triangles.empty() && triangles.size() <= max_triangles, "the number of triangles is out of range");
    for (const Vec3f& v : vertices) require(finite(v), "a vertex is not finite");
    for (const auto& t : triangles)
        for (const std::uint32_t i : t) require(i < vertices.size(), "a triangle names a vertex that is not there");

    require(!sources.empty() && sources.size() <= max_sources, "the number of sources is out of range");
    require(region_begin.size() == sources.size() + 1 && region_begin.front() == 0 &&
                region_begin.back() == triangles.size(),
            "the regions do not cover the triangles");
    for (std::size_t l = 0; l < sources.size(); ++l) {
        require(region_begin[l] < region_begin[l + 1], "a region has no triangle");
        require(finite(sources[l].position) && finite(sources[l].normal) && positive(sources[l].area),
                "a source is not finite");
    }

    require(!speeds.empty() && speeds.size() <= max_speeds, "the number of speeds is out of range");
    for (std::size_t k = 0; k < speeds.size(); ++k)
        require(positive(speeds[k]) && (k == 0 || speeds[k] > speeds[k - 1]), "the speeds are not positive and rising");
    const auto at = std::find(speeds.begin(), speeds.end(), facts.base_speed);
    require(at != speeds.end(), "the base speed is none of the speeds");
    base = static_cast<std::uint32_t>(at - speeds.begin());

    const std::size_t cells = std::size_t{directions.count()} * sources.size();
    const std::size_t swings = std::size_t{fluctuation_directions.count()} * sources.size();
    require(samples >= 1 && samples <= max_samples, "the number of samples is out of range");
    require(mean.size() == speeds.size() * cells, "the means do not match speeds, directions and sources");
    require(mean_step.size() == speeds.size(), "the means' steps do not match the speeds");
    require(step.size() == fluctuation_directions.count(), "the fluctuations do not match their directions");
    require(fluctuation.size() == swings * samples * components,
            "the fluctuations do not match their directions, sources and samples");
    for (const SourceForce& f : mean) require(finite(f.pressure) && finite(f.friction), "a mean force is not finite");
    for (const auto& s : mean_step)
        require(std::isfinite(s[0]) && std::isfinite(s[1]) && s[0] >= 0 && s[1] >= 0, "a mean's step is not a number"),
            require((s[0] > 0) == (s[1] > 0), "of a mean's two steps one is 0");
    for (const float s : step) require(std::isfinite(s) && s >= 0, "a fluctuation's step is not a number");

    require(spin.rate == 0 || positive(spin.rate), "the spin's rate is not a positive number");
    require(spin.force.size() == (spin.rate > 0 ? DirectionSet(1).count() * sources.size() : 0),
            "the spin table does not match the sources");
    require(finite(spin.centre), "the spin's centre is not finite");
    for (const SourceForce& f : spin.force)
        require(finite(f.pressure) && finite(f.friction), "a force of the spin table is not finite");
    for (std::size_t i = 0; i < 6; ++i) {
        require(added_mass[7 * i] >= 0, "the added mass has a negative number on its diagonal");
        for (std::size_t j = 0; j < 6; ++j) {
            require(std::isfinite(added_mass[6 * i + j]), "the added mass is not finite");
            require(added_mass[6 * i + j] == added_mass[6 * j + i], "the added mass is not symmetric");
        }
    }

    region_area.clear();
    for (std::size_t l = 0; l < sources.size(); ++l) {
        double sum = 0;
        for (std::uint32_t t = region_begin[l]; t < region_begin[l + 1]; ++t) {
            const Vec3f& a = vertices[triangles[t][0]];
            const Vec3f normal = cross(vertices[triangles[t][1]] - a, vertices[triangles[t][2]] - a);
            sum += static_cast<double>(0.5f * length(normal));
        }
        region_area.push_back(static_cast<float>(sum));
        require(sum > 0, "a region has no area");
    }
    log_speed.clear();
    if (speeds.size() > 1)
        for (const float u : speeds) log_speed.push_back(logarithm(u));
    measure_levels(*this);
    tables.fill(*this);
    detail.fill(*this);
    shape = shape_of(*this);
    require(shape.volume > 0, "the surface encloses no volume");
    clusters.build(*this);
}

}  // namespace frm
