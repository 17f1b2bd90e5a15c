#include "bake/map/formula.h"

#include <cmath>

#include "bake/map/fill.h"
#include "bake/regions/regions.h"

namespace frm::bake {

Map formula_map(const Surface& surface, std::uint32_t sources, std::uint32_t frequency, std::uint32_t samples) {
    constexpr double pi = 3.14159265358979323846, density = 1000, speed = 0.5, viscosity = 1e-6;
    Map map;
    fill_surface(map, surface, split_regions(surface, sources));
    map.directions = map.fluctuation_directions = DirectionSet(frequency);
    map.samples = samples;
    const SurfaceProperties shape = measure(surface);
    const double size = std::cbrt(shape.volume), dynamic = 0.5 * density * speed * speed;
    const double reynolds = speed * size / viscosity;
    map.facts = {static_cast<float>(speed),
                 static_cast<float>(20 * size / speed),
                 static_cast<float>(density),
                 static_cast<float>(viscosity),
                 static_cast<float>(size),
                 static_cast<float>(reynolds),
                 static_cast<float>(reynolds),
                 0,
                 0,
                 0,
                 0};
    map.speeds.assign(1, map.facts.base_speed);

    Tables tables;
    for (std::uint32_t d = 0; d < map.directions.count(); ++d) {
        const Vec3d e = map.directions.direction(d);
        Fluctuation f;
        for (const Source& source : map.sources) {
            const Vec3d n(source.normal);
            const double along = dot(n, e), area = static_cast<double>(source.area);
            const Vec3d pressure = n * (dynamic * area * along * along * (along < 0 ? -1.0 : 0.5));
            const Vec3d friction = e * (0.01 * dynamic * area);
            tables.mean.push_back({Vec3f(pressure), Vec3f(friction)});
            for (std::uint32_t s = 0; s < samples; ++s) {
                const double wave = 0.1 * std::sin(4 * pi * s / samples);
                for (int c = 0; c < 3; ++c) f.push_back(static_cast<float>(wave * pressure[c]));
                for (int c = 0; c < 3; ++c) f.push_back(static_cast<float>(wave * friction[c]));
            }
        }
        tables.fluctuation.push_back(std::move(f));
    }
    fill_tables(map, tables, 1e-4);
    map.provenance = R"({"solver":"formula"})";
    map.complete();
    return map;
}

}  // namespace frm::bake
