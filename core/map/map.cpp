#include "core/map/map.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace frm {

Map::Map(std::pmr::memory_resource* memory)
    : vertices(memory),
      triangles(memory),
      region_begin(memory),
      sources(memory),
      mean(memory),
      step(memory),
      fluctuation(memory),
      provenance(memory),
      triangle_area(memory),
      region_area(memory),
      file(memory) {}

namespace {

bool finite(const Vec3f& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void require(bool condition, const char* what) {
    if (!condition) throw Error(FRM_ERROR_CORRUPT, "map: %s", what);
}

bool positive(float v) { return std::isfinite(v) && v > 0; }

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

}  // namespace

void Map::complete() {
    require(positive(facts.base_speed), "the base speed is not a positive number");
    require(positive(facts.period), "the period is not a positive number");
    require(positive(facts.density), "the density is not a positive number");
    require(positive(facts.viscosity), "the viscosity is not a positive number");
    require(positive(facts.reference_length), "the reference length is not a positive number");
    require(facts.quantisation_error >= 0 && facts.quantisation_error < 1, "the quantisation error is out of range");

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

    const std::size_t cells = std::size_t{directions.count()} * sources.size();
    require(samples >= 1 && samples <= max_samples, "the number of samples is out of range");
    require(mean.size() == cells, "the means do not match directions and sources");
    require(step.size() == directions.count(), "the fluctuations do not match the directions");
    require(fluctuation.size() == cells * samples * components,
            "the fluctuations do not match directions, sources and samples");
    for (const SourceForce& f : mean) require(finite(f.pressure) && finite(f.friction), "a mean force is not finite");
    for (const float s : step) require(std::isfinite(s) && s >= 0, "a fluctuation's step is not a number");

    triangle_area.clear();
    region_area.clear();
    for (std::size_t l = 0; l < sources.size(); ++l) {
        double sum = 0;
        for (std::uint32_t t = region_begin[l]; t < region_begin[l + 1]; ++t) {
            const Vec3f& a = vertices[triangles[t][0]];
            triangle_area.push_back(0.5f * length(cross(vertices[triangles[t][1]] - a, vertices[triangles[t][2]] - a)));
            sum += static_cast<double>(triangle_area.back());
        }
        region_area.push_back(static_cast<float>(sum));
        require(sum > 0, "a region has no area");
    }
    shape = shape_of(*this);
    require(shape.volume > 0, "the surface encloses no volume");
}

}  // namespace frm
