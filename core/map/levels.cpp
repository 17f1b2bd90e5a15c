#include "core/map/levels.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/map/map.h"

namespace frm {

Level::Level(std::pmr::memory_resource* memory)
    : begin(memory),
      position{std::pmr::vector<float>(memory), std::pmr::vector<float>(memory), std::pmr::vector<float>(memory)},
      area(memory),
      rows(memory),
      spin(memory) {}

MapLevels::MapLevels(std::pmr::memory_resource* memory)
    : order(memory), level(memory), most_pressure(memory), most_friction(memory) {}

float Level::error(const LevelMotion& m, float reach) const {
    const float fastest = m.speed + m.turning * reach;
    const float pressure =
        m.turning * (bound.turning * m.speed + bound.turning_squared * m.turning) + bound.swing * fastest * fastest;
    const float friction = bound.turning_friction * m.turning + bound.swing_friction * fastest;
    return m.pressure * pressure + m.friction * friction;
}

namespace {

/// Halves sources[first, last) along the longest side of the box around them, `depth` times.
void halve(const Map& map, std::pmr::vector<std::uint32_t>& order, std::size_t first, std::size_t last,
           std::uint32_t depth) {
    if (depth == 0 || last - first < 2) return;
    Vec3f low = map.sources[order[first]].position, high = low;
    for (std::size_t i = first; i < last; ++i) {
        const Vec3f& p = map.sources[order[i]].position;
        for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
    }
    int axis = 0;
    for (int k = 1; k < 3; ++k)
        if (high[k] - low[k] > high[axis] - low[axis]) axis = k;
    const auto at = [&](std::size_t i) { return order.begin() + static_cast<std::ptrdiff_t>(i); };
    std::sort(at(first), at(last), [&](std::uint32_t a, std::uint32_t b) {
        const float pa = map.sources[a].position[axis], pb = map.sources[b].position[axis];
        return pa < pb || (!(pb < pa) && a < b);
    });
    const std::size_t middle = (first + last) / 2;
    halve(map, order, first, middle, depth - 1);
    halve(map, order, middle, last, depth - 1);
}

/// For one source, over all directions and speeds: the largest force, and how steep it is.
struct Steepness {
    double pressure = 0, friction = 0;                    ///< N, the largest
    double pressure_gradient = 0, friction_gradient = 0;  ///< N: L, of u^2 R(e) and of u R(e), u in units of u0
};

/// A face of the octahedron: within it R(e) = M p with p = u / |u|_1 and M = (R at the corners) V^-1. At |u| = 1
///   grad(u^2 R) = (2 u - s / |u|_1) x R + M / |u|_1,   grad(u R) = (u - s / |u|_1) x R + M / |u|_1
/// with s the signs of u, and |2 u - s / |u|_1| <= sqrt(3), |u - s / |u|_1| <= sqrt(2), |u|_1 >= 1.
class Face {
public:
    Face(const DirectionSet& set, const FaceCorners& corners) {
        Vec3d v[3];
        for (int k = 0; k < 3; ++k) {
            v[k] = set.direction(corners.index[k]);
            v[k] = v[k] / (std::fabs(v[k].x) + std::fabs(v[k].y) + std::fabs(v[k].z));
        }
        const double volume = dot(v[0], cross(v[1], v[2]));
        for (int k = 0; k < 3; ++k) row_[k] = cross(v[(k + 1) % 3], v[(k + 2) % 3]) / volume;
    }
    /// |M|, of three corners' forces.
    double slope(const Vec3d (&r)[3]) const {
        double sum = 0;
        for (int c = 0; c < 3; ++c) {
            const Vec3d m = row_[0] * r[0][c] + row_[1] * r[1][c] + row_[2] * r[2][c];
            sum += dot(m, m);
        }
        return std::sqrt(sum);
    }

private:
    Vec3d row_[3];  ///< of V^-1
};

void measure_face(const Map& map, const Face& face, const FaceCorners& corners, std::size_t source, Steepness& out) {
    const std::size_t sources = map.sources.size(), cells = map.directions.count() * sources;
    // [pressure, friction], the largest of all speeds: between them R is a mean of theirs.
    double most[2] = {}, slope[2] = {}, by_speed[2] = {};
    for (std::size_t k = 0; k < map.speeds.size(); ++k) {
        Vec3d r[2][3];
        for (int i = 0; i < 3; ++i) {
            const SourceForce& f = map.mean[k * cells + corners.index[i] * sources + source];
            r[0][i] = Vec3d(f.pressure), r[1][i] = Vec3d(f.friction);
            if (k == 0) continue;
            // R is linear in log u: u dR/du adds to the gradient.
            const SourceForce& g = map.mean[(k - 1) * cells + corners.index[i] * sources + source];
            const double between = std::max(1e-6, static_cast<double>(map.log_speed[k] - map.log_speed[k - 1]));
            by_speed[0] = std::max(by_speed[0], length(r[0][i] - Vec3d(g.pressure)) / between);
            by_speed[1] = std::max(by_speed[1], length(r[1][i] - Vec3d(g.friction)) / between);
        }
        for (int part = 0; part < 2; ++part) {
            for (const Vec3d& corner : r[part]) most[part] = std::max(most[part], length(corner));
            slope[part] = std::max(slope[part], face.slope(r[part]));
        }
    }
    out.pressure = std::max(out.pressure, most[0]);
    out.friction = std::max(out.friction, most[1]);
    out.pressure_gradient = std::max(out.pressure_gradient, std::sqrt(3.0) * most[0] + slope[0] + by_speed[0]);
    out.friction_gradient = std::max(out.friction_gradient, std::sqrt(2.0) * most[1] + slope[1] + by_speed[1]);
}

void add(ForceRow& to, const Vec3d& pressure, const Vec3d& friction) {
    for (int c = 0; c < 3; ++c) {
        to.v[c] += static_cast<float>(pressure[c]);
        to.v[c + 4] += static_cast<float>(friction[c]);
    }
}

/// Sums of `cells` rows of all sources by groups: the forces, then their torques about the groups' centres.
void sum_rows(const Map& map, const MapLevels& levels, const Level& level, const std::pmr::vector<SourceForce>& from,
              std::pmr::vector<ForceRow>& out) {
    const std::size_t sources = map.sources.size(), cells = from.size() / sources;
    out.resize(2 * cells * level.groups);
    for (std::size_t g = 0; g < level.groups; ++g) {
        const Vec3d centre(level.position[0][g], level.position[1][g], level.position[2][g]);
        for (std::size_t cell = 0; cell < cells; ++cell) {
            Vec3d force[2], torque[2];
            for (std::uint32_t i = level.begin[g]; i < level.begin[g + 1]; ++i) {
                const std::uint32_t l = levels.order[i];
                const SourceForce& f = from[cell * sources + l];
                const Vec3d arm = Vec3d(map.sources[l].position) - centre;
                force[0] += Vec3d(f.pressure), torque[0] += cross(arm, Vec3d(f.pressure));
                force[1] += Vec3d(f.friction), torque[1] += cross(arm, Vec3d(f.friction));
            }
            out[cell * level.groups + g] = {};
            out[(cells + cell) * level.groups + g] = {};
            add(out[cell * level.groups + g], force[0], force[1]);
            add(out[(cells + cell) * level.groups + g], torque[0], torque[1]);
        }
    }
}

/// Rounded up a little: a bound must not lose by being a float.
float above(double v) { return static_cast<float>(v * 1.0001); }

void fill_level(const Map& map, const MapLevels& levels, const std::pmr::vector<Steepness>& steep, Level& level) {
    for (auto& p : level.position) p.assign((level.groups + lookup_block - 1) / lookup_block * lookup_block, 0.0f);
    level.area.resize(level.groups);
    double turning = 0, squared = 0, friction = 0;
    for (std::size_t g = 0; g < level.groups; ++g) {
        Vec3d moment;
        double area = 0;
        for (std::uint32_t i = level.begin[g]; i < level.begin[g + 1]; ++i) {
            const Source& s = map.sources[levels.order[i]];
            moment += Vec3d(s.position) * static_cast<double>(s.area);
            area += static_cast<double>(s.area);
        }
        const Vec3f centre(moment / area);
        level.area[g] = static_cast<float>(area);
        for (int k = 0; k < 3; ++k) level.position[k][g] = centre[k];
        for (std::uint32_t i = level.begin[g]; i < level.begin[g + 1]; ++i) {
            const std::uint32_t l = levels.order[i];
            const Vec3d at(map.sources[l].position);
            const double away = length(at - Vec3d(centre)), arm = std::max(length(at), length(Vec3d(centre)));
            turning += steep[l].pressure_gradient * away;
            squared += steep[l].pressure_gradient * away * arm;
            friction += steep[l].friction_gradient * away;
        }
    }
    sum_rows(map, levels, level, map.mean, level.rows);
    sum_rows(map, levels, level, map.spin.force, level.spin);
    level.bound.turning = above(turning);
    level.bound.turning_squared = above(squared);
    level.bound.turning_friction = above(friction);
    level.bound.swing = above(static_cast<double>(map.tables.swing_pressure));
    level.bound.swing_friction = above(static_cast<double>(map.tables.swing_friction));
}

}  // namespace

void MapLevels::fill(const Map& map) {
    const std::size_t sources = map.sources.size();
    std::uint32_t depth = 0;
    while (depth < most && (std::size_t{2} << depth) <= sources) ++depth;  // groups of two at least
    order.resize(sources);
    std::iota(order.begin(), order.end(), 0u);
    halve(map, order, 0, sources, depth);

    std::pmr::vector<Steepness> steep(sources, order.get_allocator());
    for (const FaceCorners& corners : map.tables.corners) {
        const Face face(map.directions, corners);
        for (std::size_t l = 0; l < sources; ++l) measure_face(map, face, corners, l, steep[l]);
    }
    most_pressure.resize(sources);
    most_friction.resize(sources);
    for (std::size_t l = 0; l < sources; ++l) {
        most_pressure[l] = above(steep[l].pressure);
        most_friction[l] = above(steep[l].friction);
    }
    level.clear();
    std::pmr::vector<std::uint32_t> begin(order.get_allocator());
    begin = {0, static_cast<std::uint32_t>(sources)};
    for (std::uint32_t k = 0; k < depth; ++k) {
        level.emplace_back(order.get_allocator().resource());
        level.back().groups = 1u << k;
        level.back().begin = begin;
        fill_level(map, *this, steep, level.back());
        for (std::size_t i = begin.size() - 1; i > 0; --i)
            begin.insert(begin.begin() + static_cast<std::ptrdiff_t>(i), (begin[i - 1] + begin[i]) / 2);
    }
}

LookupTable lookup_table(const Map& map, const Level& level) {
    LookupTable out = lookup_table(map);
    out.sources = level.groups;
    out.x = level.position[0].data();
    out.y = level.position[1].data();
    out.z = level.position[2].data();
    out.mean = level.rows.data();
    out.torque = static_cast<std::ptrdiff_t>(level.rows.size() / 2);
    out.spin = level.spin.empty() ? nullptr : level.spin.data();
    out.spin_torque = static_cast<std::ptrdiff_t>(level.spin.size() / 2);
    return out;
}

}  // namespace frm
