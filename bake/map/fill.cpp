#include "bake/map/fill.h"

#include <algorithm>
#include <cmath>

namespace frm::bake {

void fill_surface(Map& map, const Surface& surface, const Regions& regions) {
    map.vertices.clear();
    for (const Vec3d& v : surface.vertices) map.vertices.push_back(Vec3f(v));
    map.triangles.clear();
    map.region_begin.assign(1, 0u);
    map.sources.clear();
    for (std::uint32_t l = 0; l < regions.count; ++l) {
        Vec3d moment, normal;
        double area = 0;
        for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
            if (regions.region[t] != l) continue;
            const Vec3d a = surface.corner(t, 0), b = surface.corner(t, 1), c = surface.corner(t, 2);
            const Vec3d n = cross(b - a, c - a) * 0.5;
            area += length(n);
            normal += n;
            moment += (a + b + c) * (length(n) / 3);
            map.triangles.push_back(surface.triangles[t]);
        }
        map.region_begin.push_back(static_cast<std::uint32_t>(map.triangles.size()));
        map.sources.push_back({Vec3f(moment / area), Vec3f(normal / area), static_cast<float>(area)});
    }
}

namespace {

Vec3d whole_mean(const Map& map, std::size_t direction) {
    Vec3d sum;
    for (std::size_t l = 0; l < map.sources.size(); ++l) {
        const SourceForce& f = map.mean[direction * map.sources.size() + l];
        sum += Vec3d(f.pressure) + Vec3d(f.friction);
    }
    return sum;
}

/// The force on the whole object at one sample, of pressure and friction together, without the mean.
template <typename T>
Vec3d whole_fluctuation(const Map& map, const T* values, std::size_t sample, double scale) {
    Vec3d sum;
    for (std::size_t l = 0; l < map.sources.size(); ++l) {
        const T* v = values + (l * map.samples + sample) * Map::components;
        for (int c = 0; c < 3; ++c) sum[c] += scale * (static_cast<double>(v[c]) + static_cast<double>(v[c + 3]));
    }
    return sum;
}

}  // namespace

void fill_fluctuations(Map& map, const std::vector<Fluctuation>& directions, double budget) {
    double peak = 0;
    for (std::size_t d = 0; d < directions.size(); ++d)
        for (std::size_t s = 0; s < map.samples; ++s)
            peak = std::max(peak, length(whole_mean(map, d) + whole_fluctuation(map, directions[d].data(), s, 1.0)));

    // 2 L values that each err by up to half a step, independently, add up to an error whose standard deviation is
    // step sqrt(2 L / 12) a component; three of those are the budget.
    const double wanted = budget * peak / (3 * std::sqrt(2.0 * static_cast<double>(map.sources.size()) / 12));
    const std::size_t count = map.sources.size() * map.samples * Map::components;
    map.step.clear();
    map.fluctuation.assign(directions.size() * count, 0);
    double worst = 0;
    for (std::size_t d = 0; d < directions.size(); ++d) {
        float largest = 0;
        for (const float v : directions[d]) largest = std::max(largest, std::fabs(v));
        // A value must fit 16 bits.
        const double step = std::max(wanted, static_cast<double>(largest) / 32767);
        map.step.push_back(static_cast<float>(step));
        std::int16_t* out = map.fluctuation.data() + d * count;
        if (!(step > 0)) continue;
        for (std::size_t i = 0; i < count; ++i)
            out[i] = static_cast<std::int16_t>(std::lround(static_cast<double>(directions[d][i]) / step));
        for (std::size_t s = 0; s < map.samples; ++s)
            worst = std::max(worst, length(whole_fluctuation(map, out, s, static_cast<double>(map.step.back())) -
                                           whole_fluctuation(map, directions[d].data(), s, 1.0)));
    }
    map.facts.quantisation_error = peak > 0 ? static_cast<float>(worst / peak) : 0.0f;
}

}  // namespace frm::bake
