// Eq. 6 read once more, in double precision and straight from the map's own tables, against what a tick gives.
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;

namespace {

double num(float v) { return static_cast<double>(v); }

/// The three directions around d and their weights, by search: the face of the subdivided octahedron that the ray
/// meets is the one whose three weights are not negative.
struct Around {
    std::uint32_t index[3] = {};
    double weight[3] = {};
    std::uint32_t face = 0;
};

Around around(const DirectionSet& set, const Vec3d& d) {
    Around best;
    double worst = -1e9;
    for (std::uint32_t f = 0; f < set.faces(); ++f) {
        const auto corner = set.corners(f);
        Vec3d v[3];
        for (std::size_t k = 0; k < 3; ++k) {
            v[k] = set.direction(corner[k]);
            v[k] = v[k] / (std::fabs(v[k].x) + std::fabs(v[k].y) + std::fabs(v[k].z));  // on the octahedron
        }
        const Vec3d p = d / (std::fabs(d.x) + std::fabs(d.y) + std::fabs(d.z));
        const double volume = dot(v[0], cross(v[1], v[2]));
        const double w[3] = {dot(p, cross(v[1], v[2])) / volume, dot(p, cross(v[2], v[0])) / volume,
                             dot(p, cross(v[0], v[1])) / volume};
        const double least = std::min({w[0], w[1], w[2]});
        if (dot(p, v[0] + v[1] + v[2]) < 0 || least <= worst) continue;
        worst = least;
        best.face = f;
        for (int k = 0; k < 3; ++k) best.index[k] = corner[static_cast<std::size_t>(k)], best.weight[k] = w[k];
    }
    return best;
}

/// docs/model.md, section 6: g, from the series themselves.
double level(const Map& map, const Around& e) {
    const std::size_t count = map.sources.size();
    const auto whole = [&](std::uint32_t direction, std::size_t s) {
        Vec3d sum;
        for (std::size_t l = 0; l < count; ++l) {
            const std::int16_t* v = &map.fluctuation[((direction * count + l) * map.samples + s) * 6];
            for (int c = 0; c < 3; ++c) sum[c] += v[c] + v[c + 3];
        }
        return sum * num(map.step[direction]);
    };
    double wanted = 0, found = 0;
    for (int i = 0; i < 3; ++i) {
        double square = 0;
        for (std::size_t s = 0; s < map.samples; ++s) square += dot(whole(e.index[i], s), whole(e.index[i], s));
        wanted += e.weight[i] * std::sqrt(square / map.samples);
        for (int j = 0; j < 3; ++j)
            for (std::size_t s = 0; s < map.samples; ++s)
                found += e.weight[i] * e.weight[j] * dot(whole(e.index[i], s), whole(e.index[j], s)) / map.samples;
    }
    if (!(found < wanted * wanted)) return 1;
    return found > 0.25 * wanted * wanted ? wanted / std::sqrt(found) : 2;
}

struct Reading {
    Vec3d force, torque;
};

/// Eq. 6 and the repairs of docs/model.md, for a body that is wholly in the fluid. `time`: of each source, advanced.
Reading read_eq6(const Map& map, const BodyDef& def, const Fluid& fluid, double dt, std::vector<double>& time) {
    const double c = num(def.scale), u0 = num(map.facts.base_speed), period = num(map.facts.period);
    const double rho = num(fluid.density) / num(map.facts.density);
    const double mu = rho * num(fluid.viscosity) / num(map.facts.viscosity);
    const Quat<float>& q = def.pose.rotation;
    const Rotation<double> r(Quat<double>{num(q.x), num(q.y), num(q.z), num(q.w)});
    const std::size_t count = map.sources.size(), speeds = map.speeds.size();
    const Vec3d spin = r.to_body(Vec3d(def.twist.angular));
    Reading sum;
    for (std::size_t l = 0; l < count; ++l) {
        const Vec3d at = Vec3d(map.sources[l].position) * c;
        const Vec3d stream = -(r.to_body(Vec3d(def.twist.linear)) + cross(spin, at));
        const double u = length(stream), ratio = u / u0;
        Vec3d pressure, friction;
        if (u > 0) {
            const Around e = around(map.directions, stream), f = around(map.fluctuation_directions, stream);
            const double reynolds = u * c * num(map.facts.viscosity) / num(fluid.viscosity);
            std::size_t slow = 0;
            while (slow + 2 < speeds && reynolds >= num(map.speeds[slow + 1])) ++slow;
            const std::size_t fast = std::min(slow + 1, speeds - 1);
            double share = 0;
            if (fast > slow) {
                const double a = std::log(num(map.speeds[slow])), b = std::log(num(map.speeds[fast]));
                share = std::clamp((std::log(reynolds) - a) / (b - a), 0.0, 1.0);
            }
            for (int k = 0; k < 3; ++k) {
                const SourceForce& a = map.mean[(slow * map.directions.count() + e.index[k]) * count + l];
                const SourceForce& b = map.mean[(fast * map.directions.count() + e.index[k]) * count + l];
                pressure += (Vec3d(a.pressure) * (1 - share) + Vec3d(b.pressure) * share) * e.weight[k];
                friction += (Vec3d(a.friction) * (1 - share) + Vec3d(b.friction) * share) * e.weight[k];
            }
            time[l] = std::fmod(time[l] + ratio * dt / c, period);
            const double position = time[l] / period * map.samples, before = std::floor(position);
            const std::size_t s0 = static_cast<std::size_t>(before) % map.samples, s1 = (s0 + 1) % map.samples;
            const double g = level(map, f);
            for (int k = 0; k < 3; ++k) {
                const std::int16_t* v = &map.fluctuation[(f.index[k] * count + l) * map.samples * 6];
                const auto value = [&](std::size_t i) {
                    return v[s0 * 6 + i] + (position - before) * (v[s1 * 6 + i] - v[s0 * 6 + i]);
                };
                const double w = g * f.weight[k] * num(map.step[f.index[k]]);
                pressure += Vec3d(value(0), value(1), value(2)) * w;
                friction += Vec3d(value(3), value(4), value(5)) * w;
            }
            pressure *= ratio * ratio * rho * c * c;
            friction *= ratio * mu * c;
        }
        if (map.spin.rate > 0 && length(spin) > 0) {
            const Around e = around(DirectionSet(1), spin);
            const double faster = length(spin) / num(map.spin.rate);
            for (int k = 0; k < 3; ++k) {
                const SourceForce& f = map.spin.force[e.index[k] * count + l];
                pressure += Vec3d(f.pressure) * (e.weight[k] * faster * faster * rho * c * c * c * c);
                friction += Vec3d(f.friction) * (e.weight[k] * faster * mu * c * c);
            }
        }
        sum.force += r.to_world(pressure + friction);
        sum.torque += r.to_world(cross(at, pressure + friction));
    }
    return sum;
}

struct Case {
    const char* name;
    Map map;
};

std::vector<Case> cases() {
    const bake::Surface box = test::fine_box({0.2, 0.1, 0.3}, 0.08);
    std::vector<Case> out;
    out.push_back({"one set of 38 directions", bake::formula_map(box, 17, 3, 64)});
    out.push_back({"two sets, three speeds, spin", test::full_map(box, 12, 32)});
    Map still = test::full_map(box, 33, 8);
    std::fill(still.step.begin(), still.step.end(), 0.0f);
    still.complete();
    out.push_back({"no fluctuation", std::move(still)});
    Map rough = bake::formula_map(box, 40, 2, 16);  // series of neighbours that have nothing in common
    std::mt19937 random(5);
    std::uniform_int_distribution<int> any(-3000, 3000);
    for (std::int16_t& v : rough.fluctuation) v = static_cast<std::int16_t>(any(random));
    rough.complete();
    out.push_back({"noise", std::move(rough)});
    out.push_back({"six directions", bake::formula_map(box, 5, 1, 1)});
    return out;
}

}  // namespace

TEST_CASE("a tick's resistance is Eq. 6 in double precision to 1e-5 of the peak", "[resistance]") {
    std::mt19937 random(20);
    std::normal_distribution<float> normal;
    std::uniform_real_distribution<float> share(0, 1);
    for (Case& c : cases()) {
        INFO(c.name);
        const auto map = std::make_shared<const Map>(std::move(c.map));
        for (const std::uint32_t skip : {skip_nothing, skip_default}) {
            const float u0 = map->facts.base_speed;
            double worst = 0, worst_torque = 0;
            for (int body_number = 0; body_number < 4; ++body_number) {
                WorldDef def;
                def.everywhere = true;
                def.skip = skip;
                def.fluid = {9.8f, 700 + 300 * share(random), 1e-6f * (0.5f + share(random))};
                World world = test::world_of(def);
                BodyDef body_def = test::body_of(map);
                body_def.scale = 0.5f + 2 * share(random);
                Body& body = world.create_body(body_def);
                std::vector<double> time(map->source_count());
                for (int i = 0; i < 250; ++i) {
                    const float speed = u0 * std::pow(10.0f, 2 * share(random) - 1);
                    const Vec3f v(normal(random), normal(random), normal(random));
                    const Vec3f w(normal(random), normal(random), normal(random));
                    Twist twist{v * (speed / length(v)), w * (speed * share(random))};
                    if (i % 10 == 0) twist.angular = {};
                    const Quat<float> q = test::turned(Vec3d(normal(random), normal(random), 1), share(random) * 6);
                    world.set_motion(body, {{1, 2, 3}, q}, twist);
                    for (std::size_t l = 0; l < time.size(); ++l) time[l] = num(body.sources[l].map_time);
                    const float dt = 0.002f + 0.1f * share(random);
                    const Reading expected = read_eq6(*map, body.def, def.fluid, num(dt), time);
                    world.tick(dt);
                    const Forces& f = body.forces;
                    // The peak at the body's speed: that of a stream of the largest relative speed.
                    const float fastest =
                        length(twist.linear) + length(twist.angular) * map->tables.reach * body.def.scale;
                    const double ratio = num(fastest / u0), c2 = num(body.def.scale * body.def.scale);
                    const double peak =
                        num(map->tables.peak_pressure) * ratio * ratio * c2 * num(def.fluid.density) / 1000;
                    worst = std::max(worst,
                                     length(expected.force - Vec3d(f.pressure.force) - Vec3d(f.friction.force)) / peak);
                    worst_torque = std::max(
                        worst_torque, length(expected.torque - Vec3d(f.pressure.torque) - Vec3d(f.friction.torque)) /
                                          (peak * num(map->tables.reach * body.def.scale)));
                }
            }
            CHECK(worst < 1e-5);
            CHECK(worst_torque < 1e-5);
            CHECK(worst > 0);
        }
    }
}

TEST_CASE("what is skipped stays within its bound, and is counted", "[resistance]") {
    // A map whose friction is next to nothing, and of whose sources all but two hardly fluctuate.
    Map map = bake::formula_map(test::fine_box({0.2, 0.1, 0.3}, 0.08), 20, 3, 32);
    for (SourceForce& f : map.mean) f.friction *= 1e-6f;
    const std::size_t row = map.samples * Map::components;
    for (std::size_t r = 0; r < map.fluctuation.size() / row; ++r)
        for (std::size_t i = 0; i < row; ++i) {
            std::int16_t& v = map.fluctuation[r * row + i];
            const std::size_t l = r % map.source_count();
            if (l > 1) v = static_cast<std::int16_t>(v > 1 ? 1 : v < -1 ? -1 : v);
            if (i % 6 > 2) v = 0;
        }
    for (float& s : map.step) s *= 0.002f;
    map.complete();
    const auto shared = std::make_shared<const Map>(map);
    REQUIRE(shared->tables.steady_sources == 18);
    std::mt19937 random(21);
    std::normal_distribution<float> normal;
    WorldDef all, none, friction, steady;
    all.everywhere = none.everywhere = friction.everywhere = steady.everywhere = true;
    none.skip = skip_nothing;
    friction.skip = skip_friction;
    steady.skip = skip_steady;
    World worlds[4] = {test::world_of(all), test::world_of(none), test::world_of(friction), test::world_of(steady)};
    Body* body[4];
    for (int i = 0; i < 4; ++i) body[i] = &worlds[i].create_body(test::body_of(shared));
    double differ = 0;
    for (int n = 0; n < 2000; ++n) {
        const Twist twist{{normal(random), normal(random), normal(random)}, {normal(random), normal(random), 0}};
        for (int i = 0; i < 4; ++i) {
            worlds[i].set_motion(*body[i], {}, twist);
            worlds[i].tick(0.01f);
        }
        const auto force = [&](int i) {
            return Vec3d(body[i]->forces.pressure.force) + Vec3d(body[i]->forces.friction.force);
        };
        const double ratio =
            num((length(twist.linear) + length(twist.angular) * shared->tables.reach) / map.facts.base_speed);
        const double bound = num(skip_share) * num(shared->tables.peak_pressure) * ratio * ratio;
        const double rounding = 1e-6 * length(force(1));
        REQUIRE(length(force(0) - force(1)) < 2 * bound + rounding);
        REQUIRE(length(force(2) - force(1)) < bound + rounding);
        REQUIRE(length(force(3) - force(1)) < bound + rounding);
        REQUIRE(body[1]->skipped.friction + body[1]->skipped.steady == 0);
        REQUIRE(body[0]->skipped.friction == 20);
        REQUIRE(body[0]->skipped.steady == 18);
        REQUIRE(body[2]->skipped.steady == 0);
        REQUIRE(body[3]->skipped.friction == 0);
        REQUIRE(body[0]->forces.friction.force == Vec3f());
        differ = std::max(differ, length(force(0) - force(1)));
    }
    CHECK(differ > 0);
}

TEST_CASE("friction and fluctuations that count are not skipped", "[resistance]") {
    const auto map = test::map_of(test::fine_box({0.2, 0.1, 0.3}, 0.08), 12, 3, 64);
    WorldDef def;
    def.everywhere = true;
    World world = test::world_of(def);
    Body& body = world.create_body(test::body_of(map, {}, {}, {{0.5f, 0.2f, 0}, {}}));
    world.tick(0.01f);
    CHECK(body.skipped.friction == 0);
    CHECK(body.skipped.steady == 0);
    CHECK(length(body.forces.friction.force) > 0);
}
