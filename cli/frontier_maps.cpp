#include "cli/frontier_maps.h"

#include <cmath>
#include <utility>

#include "bake/directions/torque.h"
#include "bake/map/fill.h"
#include "bake/regions/regions.h"
#include "bake/regions/tessellate.h"
#include "core/map/codec.h"
#include "core/map/directions.h"

namespace frm::cli {
namespace {

constexpr double density = 1000, speed = 0.5, viscosity = 1e-6, pi = 3.14159265358979323846;
constexpr std::uint32_t samples = 32, fluctuation_frequency = 3;  ///< 38 directions, a standard bake's without symmetry

struct Facet {
    Vec3d centre, normal;  ///< length of the normal: the area
};

std::vector<Facet> facets_of(const bake::Surface& surface) {
    std::vector<Facet> out;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Vec3d a = surface.corner(t, 0), b = surface.corner(t, 1), c = surface.corner(t, 2);
        out.push_back({(a + b + c) / 3.0, cross(b - a, c - a) * 0.5});
    }
    return out;
}

/// What the regions feel in a stream of the base speed along e, and the torque of all triangles about `centre`.
struct Stream {
    std::vector<bake::PatchForce> forces;
    Vec3d torque;
};

Stream stream_along(const Vec3d& e, const std::vector<Facet>& facets, const bake::Regions& regions,
                    const Vec3d& centre) {
    constexpr double dynamic = 0.5 * density * speed * speed;
    Stream out{std::vector<bake::PatchForce>(regions.count), {}};
    for (std::size_t t = 0; t < facets.size(); ++t) {
        const double area = length(facets[t].normal);
        if (!(area > 0)) continue;
        const double along = dot(facets[t].normal, e) / area;
        const Vec3d pressure = facets[t].normal * (dynamic * along * along * (along < 0 ? -1.0 : 0.5));
        const Vec3d friction = e * (0.01 * dynamic * area);
        bake::PatchForce& f = out.forces[regions.region[t]];
        f.pressure += pressure;
        f.friction += friction;
        out.torque += cross(facets[t].centre - centre, pressure + friction);
    }
    return out;
}

}  // namespace

MapFile law_map(const bake::Surface& surface, const LawMap& settings) {
    const bake::Regions regions = bake::split_regions(surface, settings.sources);
    const bake::SurfaceProperties shape = bake::measure(surface);
    const std::vector<Facet> facets = facets_of(surface);
    Map map;
    bake::fill_surface(map, surface, regions);
    map.directions = DirectionSet(settings.frequency);
    map.fluctuation_directions = DirectionSet(fluctuation_frequency);
    map.samples = samples;
    const double size = std::cbrt(shape.volume);
    map.facts.base_speed = static_cast<float>(speed);
    map.facts.period = static_cast<float>(20 * size / speed);
    map.facts.density = static_cast<float>(density);
    map.facts.viscosity = static_cast<float>(viscosity);
    map.facts.reference_length = static_cast<float>(size);
    map.facts.reynolds = map.facts.reynolds_solved = static_cast<float>(speed * size / viscosity);
    map.speeds.assign(1, map.facts.base_speed);

    bake::Tables tables;
    for (std::uint32_t d = 0; d < map.directions.count(); ++d) {
        Stream stream = stream_along(map.directions.direction(d), facets, regions, shape.centroid);
        bake::restore_torque(stream.forces, map.sources, shape.centroid, stream.torque);
        for (const bake::PatchForce& f : stream.forces) tables.mean.push_back({Vec3f(f.pressure), Vec3f(f.friction)});
    }
    for (std::uint32_t d = 0; d < map.fluctuation_directions.count(); ++d) {
        const Stream stream = stream_along(map.fluctuation_directions.direction(d), facets, regions, shape.centroid);
        bake::Fluctuation f;
        for (const bake::PatchForce& force : stream.forces)
            for (std::uint32_t s = 0; s < samples; ++s) {
                const double wave = 0.1 * std::sin(4 * pi * s / samples);
                for (int c = 0; c < 3; ++c) f.push_back(static_cast<float>(wave * force.pressure[c]));
                for (int c = 0; c < 3; ++c) f.push_back(static_cast<float>(wave * force.friction[c]));
            }
        tables.fluctuation.push_back(std::move(f));
    }
    bake::fill_tables(map, tables, settings.rounding);
    map.provenance = R"({"solver":"law"})";
    map.complete();
    return std::make_shared<const std::vector<std::uint8_t>>(encode_map(map));
}

bake::Surface box_surface(const Vec3d& size, const Vec3d& centre, std::uint32_t triangles) {
    bake::Surface box;
    for (int i = 0; i < 8; ++i)
        box.vertices.push_back(centre + Vec3d((i & 1 ? 0.5 : -0.5) * size.x, (i & 2 ? 0.5 : -0.5) * size.y,
                                              (i & 4 ? 0.5 : -0.5) * size.z));
    box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                     {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return bake::tessellate(box, 1e-5, triangles).surface;
}

bake::Surface ellipsoid_surface(const Vec3d& half_axes, std::uint32_t n) {
    const DirectionSet set(n);
    bake::Surface out;
    for (std::uint32_t d = 0; d < set.count(); ++d) {
        const Vec3d e = set.direction(d);
        out.vertices.emplace_back(e.x * half_axes.x, e.y * half_axes.y, e.z * half_axes.z);
    }
    for (std::uint32_t face = 0; face < set.faces(); ++face) {
        bake::Triangle t = set.corners(face);
        const Vec3d a = out.vertices[t[0]], b = out.vertices[t[1]], c = out.vertices[t[2]];
        if (dot(cross(b - a, c - a), a + b + c) < 0) std::swap(t[1], t[2]);
        out.triangles.push_back(t);
    }
    return out;
}

}  // namespace frm::cli
