#include "bake/map/fill.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

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

void require(bool condition, const char* what) {
    if (!condition) throw Error(FRM_ERROR_INTERNAL, "tables: %s", what);
}

void require_match(const Map& map, const Tables& tables) {
    const std::size_t sources = map.sources.size();
    require(tables.mean.size() == map.speeds.size() * map.directions.count() * sources,
            "the means do not match speeds, directions and sources");
    require(tables.fluctuation.size() == map.fluctuation_directions.count(),
            "the fluctuations do not match their directions");
    for (const Fluctuation& f : tables.fluctuation)
        require(f.size() == sources * map.samples * Map::components,
                "a fluctuation does not match sources and samples");
    const auto finite = [](float v) { return std::isfinite(v); };
    for (const Fluctuation& f : tables.fluctuation)
        require(std::all_of(f.begin(), f.end(), finite), "a fluctuation is not finite");
    for (const SourceForce& f : tables.mean)
        for (int c = 0; c < 3; ++c) require(finite(f.pressure[c]) && finite(f.friction[c]), "a mean is not finite");
}

/// The tables' mean, carried to the base speed.
SourceForce base_mean(const Map& map, const Tables& tables, std::size_t speed, std::size_t cell) {
    const SourceForce& f = tables.mean[speed * map.directions.count() * map.sources.size() + cell];
    const float ratio = map.facts.base_speed / map.speeds[speed];
    return {f.pressure * (ratio * ratio), f.friction * ratio};
}

/// The force on the whole object: the sum over its sources of what `force(source)` gives.
template <typename Force>
Vec3d whole(const Map& map, Force&& force) {
    Vec3d sum;
    for (std::size_t l = 0; l < map.sources.size(); ++l) {
        const SourceForce f = force(l);
        sum += Vec3d(f.pressure) + Vec3d(f.friction);
    }
    return sum;
}

template <typename T>
Vec3d whole_sample(const Map& map, const T* values, std::size_t sample, double scale) {
    Vec3d sum;
    for (std::size_t l = 0; l < map.sources.size(); ++l) {
        const T* v = values + (l * map.samples + sample) * Map::components;
        for (int c = 0; c < 3; ++c) sum[c] += scale * (static_cast<double>(v[c]) + static_cast<double>(v[c + 3]));
    }
    return sum;
}

/// Of the force on the whole object at the base speed, fluctuation included, and of friction's mean alone.
struct Peaks {
    double force = 0, friction = 0;

    Peaks(const Map& map, const Tables& tables) {
        const std::size_t sources = map.sources.size(), base = base_speed(map);
        std::vector<Vec3d> mean;
        for (std::size_t d = 0; d < map.directions.count(); ++d) {
            const auto at = [&](std::size_t l) { return base_mean(map, tables, base, d * sources + l); };
            mean.push_back(whole(map, at));
            force = std::max(force, length(mean.back()));
            friction = std::max(friction, length(whole(map, [&](std::size_t l) {
                                    return SourceForce{{}, at(l).friction};
                                })));
        }
        for (std::uint32_t d = 0; d < map.fluctuation_directions.count(); ++d) {
            const DirectionWeights e = map.directions.interpolate(Vec3f(map.fluctuation_directions.direction(d)));
            Vec3d here;
            for (int k = 0; k < 3; ++k) here += mean[e.index[k]] * static_cast<double>(e.weight[k]);
            for (std::size_t s = 0; s < map.samples; ++s)
                force = std::max(force, length(here + whole_sample(map, tables.fluctuation[d].data(), s, 1.0)));
        }
    }

private:
    static std::size_t base_speed(const Map& map) {
        const auto at = std::find(map.speeds.begin(), map.speeds.end(), map.facts.base_speed);
        require(at != map.speeds.end(), "the base speed is none of the speeds");
        return static_cast<std::size_t>(at - map.speeds.begin());
    }
};

/// N, of the worst direction of a speed.
double mean_error(const Map& map, const Tables& tables, std::size_t speed) {
    const std::size_t sources = map.sources.size(), count = map.directions.count();
    const double ratio = static_cast<double>(map.facts.base_speed) / static_cast<double>(map.speeds[speed]);
    double worst = 0;
    for (std::size_t d = 0; d < count; ++d) {
        Vec3d sum;
        for (std::size_t l = 0; l < sources; ++l) {
            const std::size_t at = (speed * count + d) * sources + l;
            sum += Vec3d(map.mean[at].pressure) - Vec3d(tables.mean[at].pressure) * (ratio * ratio);
            sum += Vec3d(map.mean[at].friction) - Vec3d(tables.mean[at].friction) * ratio;
        }
        worst = std::max(worst, length(sum));
    }
    return worst;
}

/// N, of the worst sample of a direction.
double fluctuation_error(const Map& map, const Tables& tables, std::size_t direction) {
    const std::size_t count = map.sources.size() * map.samples * Map::components;
    double worst = 0;
    for (std::size_t s = 0; s < map.samples; ++s)
        worst = std::max(worst, length(whole_sample(map, map.fluctuation.data() + direction * count, s,
                                                    static_cast<double>(map.step[direction])) -
                                       whole_sample(map, tables.fluctuation[direction].data(), s, 1.0)));
    return worst;
}

/// The step of L values a component that are summed up: each errs by up to half a step, independently, so that the sum
/// errs by step sqrt(L / 12); three of those are the budget.
double first_step(double budget, double values) { return budget / (3 * std::sqrt(values / 12)); }

/// A value must fit 16 bits.
float fitting(double step, double largest) { return static_cast<float>(std::max(step, largest / 32767)); }

std::int16_t multiple(float value, float step) {
    return static_cast<std::int16_t>(std::min(32767.0f, std::max(-32767.0f, std::round(value / step))));
}

constexpr int attempts = 40;
constexpr double finer = 0.85;

void round_means(Map& map, const Tables& tables, std::size_t speed, double budget, double friction_budget) {
    const std::size_t cells = map.directions.count() * map.sources.size();
    SourceForce* out = map.mean.data() + speed * cells;
    double largest[2] = {};
    for (std::size_t i = 0; i < cells; ++i) {
        const SourceForce f = base_mean(map, tables, speed, i);
        for (int c = 0; c < 3; ++c) {
            largest[0] = std::max(largest[0], static_cast<double>(std::fabs(f.pressure[c])));
            largest[1] = std::max(largest[1], static_cast<double>(std::fabs(f.friction[c])));
        }
    }
    double pressure = first_step(budget, static_cast<double>(map.sources.size()));
    double friction = first_step(std::min(budget, friction_budget), static_cast<double>(map.sources.size()));
    for (int i = 0; i < attempts; ++i, pressure *= finer, friction *= finer) {
        std::array<float, 2>& step = map.mean_step[speed];
        step = {fitting(pressure, largest[0]), fitting(friction, largest[1])};
        // Where one kind is zero throughout, any step holds it.
        if (!(step[0] > 0)) step[0] = step[1];
        if (!(step[1] > 0)) step[1] = step[0];
        for (std::size_t k = 0; k < cells; ++k) {
            out[k] = base_mean(map, tables, speed, k);
            if (!(step[0] > 0)) continue;
            for (int c = 0; c < 3; ++c) {
                out[k].pressure[c] = step[0] * static_cast<float>(multiple(out[k].pressure[c], step[0]));
                out[k].friction[c] = step[1] * static_cast<float>(multiple(out[k].friction[c], step[1]));
            }
        }
        if (mean_error(map, tables, speed) <= budget) return;
    }
}

void round_fluctuation(Map& map, const Tables& tables, std::size_t direction, double budget) {
    const Fluctuation& from = tables.fluctuation[direction];
    std::int16_t* out = map.fluctuation.data() + direction * from.size();
    double largest = 0;
    for (const float v : from) largest = std::max(largest, static_cast<double>(std::fabs(v)));
    double step = first_step(budget, 2.0 * static_cast<double>(map.sources.size()));
    for (int i = 0; i < attempts; ++i, step *= finer) {
        const float kept = map.step[direction] = fitting(step, largest);
        for (std::size_t k = 0; k < from.size() && kept > 0; ++k) out[k] = multiple(from[k], kept);
        if (fluctuation_error(map, tables, direction) <= budget) return;
    }
}

}  // namespace

void fill_tables(Map& map, const Tables& tables, double budget) {
    require_match(map, tables);
    const std::size_t sources = map.sources.size();
    const Peaks peaks(map, tables);
    map.mean.assign(tables.mean.size(), SourceForce());
    map.mean_step.assign(map.speeds.size(), {0, 0});
    for (std::size_t k = 0; k < map.speeds.size(); ++k)
        round_means(map, tables, k, budget / 3 * peaks.force, 5 * budget / 3 * peaks.friction);
    map.step.assign(map.fluctuation_directions.count(), 0.0f);
    map.fluctuation.assign(map.fluctuation_directions.count() * sources * map.samples * Map::components, 0);
    for (std::size_t d = 0; d < map.step.size(); ++d) round_fluctuation(map, tables, d, 2 * budget / 3 * peaks.force);
    // Stated in single precision, and not below what was found.
    const double error = rounding_error(map, tables);
    float stated = static_cast<float>(error);
    if (static_cast<double>(stated) < error) stated = std::nextafter(stated, 1.0f);
    map.facts.quantisation_error = stated;
}

double rounding_error(const Map& map, const Tables& tables) {
    require_match(map, tables);
    const double peak = Peaks(map, tables).force;
    double mean = 0, fluctuation = 0;
    for (std::size_t k = 0; k < map.speeds.size(); ++k) mean = std::max(mean, mean_error(map, tables, k));
    for (std::size_t d = 0; d < map.step.size(); ++d)
        fluctuation = std::max(fluctuation, fluctuation_error(map, tables, d));
    return peak > 0 ? (mean + fluctuation) / peak : 0;
}

}  // namespace frm::bake
