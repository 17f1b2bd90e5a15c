// Buoyancy and weight against exact answers.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <random>

#include "core/kernels/kernels.h"
#include "core/water/snapshot.h"

#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;
using test::body_of;

namespace {

constexpr double rho_g = 1000.0 * 9.80665;
constexpr double pi = 3.14159265358979323846;

Forces forces_of(const BodyDef& def, const WorldDef& world_def = {}) {
    World world = test::world_of(world_def);
    Body& body = world.create_body(def);
    world.tick(0.002f);
    return body.forces;
}

/// Volume of a convex body under the plane z = 0 and the moment of that volume, by cutting its tetrahedra (a fan from
/// the origin of signed volumes) in double precision: another way than integrating pressure over the surface.
struct Submerged {
    double volume = 0;
    Vec3d moment;
};

void add_tetrahedron(Submerged& sum, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d, double sign) {
    const Vec3d p[4] = {a, b, c, d};
    int order[4], below = 0;
    for (int i = 0; i < 4; ++i)
        if (p[i].z < 0) order[below++] = i;
    int at = below;
    for (int i = 0; i < 4; ++i)
        if (!(p[i].z < 0)) order[at++] = i;
    const auto add = [&](const Vec3d& q, const Vec3d& r, const Vec3d& s, const Vec3d& t) {
        const double v = sign * std::fabs(dot(r - q, cross(s - q, t - q))) / 6;
        sum.volume += v;
        sum.moment += (q + r + s + t) * (v / 4);
    };
    const auto cut = [&](int i, int j) {
        const Vec3d &u = p[order[i]], &w = p[order[j]];
        return u + (w - u) * (u.z / (u.z - w.z));
    };
    const Vec3d &q = p[order[0]], &r = p[order[1]], &s = p[order[2]], &t = p[order[3]];
    if (below == 4) add(q, r, s, t);
    if (below == 1) add(q, cut(0, 1), cut(0, 2), cut(0, 3));
    if (below == 2) {
        const Vec3d qs = cut(0, 2), qt = cut(0, 3), rs = cut(1, 2), rt = cut(1, 3);
        add(q, r, qs, qt), add(r, qs, qt, rs), add(r, qt, rs, rt);
    }
    if (below == 3) {
        const Vec3d qt = cut(0, 3), rt = cut(1, 3), st = cut(2, 3);
        add(q, r, s, qt), add(r, s, qt, rt), add(s, qt, rt, st);
    }
}

Submerged submerged(const Map& map, const BodyDef& def) {
    const Rotation<double> rotation(
        Quat<double>{static_cast<double>(def.pose.rotation.x), static_cast<double>(def.pose.rotation.y),
                     static_cast<double>(def.pose.rotation.z), static_cast<double>(def.pose.rotation.w)});
    Submerged sum;
    const auto place = [&](const Vec3f& v) {
        return rotation.to_world(Vec3d(v) * static_cast<double>(def.scale)) + def.pose.position;
    };
    const Vec3d apex = def.pose.position;
    for (const auto& t : map.triangles) {
        const Vec3d a = place(map.vertices[t[0]]), b = place(map.vertices[t[1]]), c = place(map.vertices[t[2]]);
        add_tetrahedron(sum, apex, a, b, c, dot(a - apex, cross(b - apex, c - apex)) > 0 ? 1 : -1);
    }
    return sum;
}

/// A map's triangles in the world, in double precision.
class PlacedMap {
public:
    PlacedMap(const Map& map, const BodyDef& def) : map_(map) {
        const Rotation<double> rotation(
            Quat<double>{static_cast<double>(def.pose.rotation.x), static_cast<double>(def.pose.rotation.y),
                         static_cast<double>(def.pose.rotation.z), static_cast<double>(def.pose.rotation.w)});
        for (const Vec3f& v : map.vertices)
            vertices_.push_back(rotation.to_world(Vec3d(v) * static_cast<double>(def.scale)) + def.pose.position);
    }
    std::array<Vec3d, 3> corners(std::size_t t) const {
        return {vertices_[map_.triangles[t][0]], vertices_[map_.triangles[t][1]], vertices_[map_.triangles[t][2]]};
    }

private:
    const Map& map_;
    std::vector<Vec3d> vertices_;
};

/// Pressure over a wet surface, per unit of rho g, torque about the world's origin.
struct WaveForce {
    Vec3d force, torque;
    double area = 0;
};

/// A triangle under the water, whose height(point) is taken as linear within each of 4^cuts parts.
template <typename Height>
void add_wet(WaveForce& sum, const std::array<Vec3d, 3>& p, const Height& height, int cuts) {
    if (cuts > 0) {
        const Vec3d ab = (p[0] + p[1]) * 0.5, bc = (p[1] + p[2]) * 0.5, ca = (p[2] + p[0]) * 0.5;
        for (const auto& part : {std::array<Vec3d, 3>{p[0], ab, ca}, std::array<Vec3d, 3>{ab, p[1], bc},
                                 std::array<Vec3d, 3>{ca, bc, p[2]}, std::array<Vec3d, 3>{ab, bc, ca}})
            add_wet(sum, part, height, cuts - 1);
        return;
    }
    // The polygon above depth 0, edge by edge, as a fan.
    std::vector<std::pair<Vec3d, double>> wet;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d &a = p[i], &b = p[(i + 1) % 3];
        const double da = height(a) - a.z, db = height(b) - b.z;
        if (da > 0) wet.emplace_back(a, da);
        if ((da > 0) != (db > 0)) wet.emplace_back(a + (b - a) * (da / (da - db)), 0);
    }
    for (std::size_t i = 2; i < wet.size(); ++i) {
        const auto& [a, da] = wet[0];
        const auto& [b, db] = wet[i - 1];
        const auto& [c, dc] = wet[i];
        const Vec3d normal = cross(b - a, c - a) * 0.5;
        const double depths = da + db + dc;
        sum.area += length(normal);
        sum.force += normal * (-depths / 3);
        sum.torque += cross((a + b + c) * depths + (a * da + b * db + c * dc), normal) * (-1.0 / 12);
    }
}

}  // namespace

TEST_CASE("a box is buoyant by the volume below the surface at any depth and attitude", "[buoyancy]") {
    const auto map = test::map_of(test::fine_box({0.3, 0.2, 0.5}, 0.2));
    std::mt19937 random(11);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> depth(-0.4, 0.4);
    for (int i = 0; i < 300; ++i) {
        BodyDef def = body_of(map, {0.7, -0.2, depth(random)},
                              test::turned({normal(random), normal(random), normal(random)}, normal(random)));
        def.scale = i % 2 ? 1.0f : 0.37f;
        const Submerged exact = submerged(*map, def);
        const Forces f = forces_of(def);
        const double whole = rho_g * 0.03 * std::pow(static_cast<double>(def.scale), 3);
        CHECK(std::fabs(static_cast<double>(f.buoyancy.force.z) - rho_g * exact.volume) < 1e-5 * whole);
        CHECK(std::fabs(static_cast<double>(f.buoyancy.force.x)) < 1e-5 * whole);
        CHECK(std::fabs(static_cast<double>(f.buoyancy.force.y)) < 1e-5 * whole);
        // Torque about the body's origin: the force at the centroid of the submerged volume.
        const Vec3d arm = exact.volume > 1e-9 ? exact.moment / exact.volume - def.pose.position : Vec3d();
        const Vec3d torque = cross(arm, Vec3d(0, 0, rho_g * exact.volume));
        CHECK(length(Vec3d(f.buoyancy.torque) - torque) < 1e-5 * whole);
    }
}

TEST_CASE("a sphere is buoyant by the cap below the surface", "[buoyancy]") {
    const double radius = 0.25;
    const auto map = test::map_of(test::icosphere(radius, 5), 20);
    const double polyhedron = map->shape.volume / (4.0 / 3 * pi * radius * radius * radius);
    CHECK(polyhedron > 0.998);
    for (double z = -0.3; z <= 0.3; z += 0.037) {
        const double cap = std::fmin(2 * radius, std::fmax(0, radius - z));
        const double exact = rho_g * pi * cap * cap * (3 * radius - cap) / 3;
        const Forces f = forces_of(body_of(map, {0, 0, z}, test::turned({1, 2, 3}, 0.8)));
        CHECK(static_cast<double>(f.buoyancy.force.z) == Approx(exact).margin(2.5e-3 * rho_g * map->shape.volume));
        CHECK(length(f.buoyancy.torque) < 1e-4 * rho_g * map->shape.volume);
    }
}

TEST_CASE("a sphere of triangles is buoyant by its own volume below the surface", "[buoyancy]") {
    const auto map = test::map_of(test::icosphere(0.25, 3), 20);
    const double whole = rho_g * map->shape.volume;
    std::mt19937 random(3);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> depth(-0.26, 0.26);
    for (int i = 0; i < 100; ++i) {
        const BodyDef def = body_of(map, {-0.4, 3, depth(random)},
                                    test::turned({normal(random), normal(random), normal(random)}, normal(random)));
        const Submerged exact = submerged(*map, def);
        const Forces f = forces_of(def);
        CHECK(length(Vec3d(f.buoyancy.force) - Vec3d(0, 0, rho_g * exact.volume)) < 1e-5 * whole);
        const Vec3d arm = exact.volume > 1e-9 ? exact.moment / exact.volume - def.pose.position : Vec3d();
        CHECK(length(Vec3d(f.buoyancy.torque) - cross(arm, Vec3d(0, 0, rho_g * exact.volume))) < 1e-5 * whole);
    }
}

TEST_CASE("weight acts at the centre of mass", "[buoyancy]") {
    BodyDef def = body_of(test::map_of(test::box({0.1, 0.1, 0.1}), 6), {0, 0, 5}, test::turned({0, 1, 0}, pi / 2));
    def.mass = 2;
    def.scale = 2;
    def.centre_of_mass = {0.3f, 0, 0};  // turned to -z: no lever
    Forces f = forces_of(def);
    CHECK(f.gravity.force.z == Approx(-2 * 9.80665));
    CHECK(length(f.gravity.torque) < 1e-4f);
    def.centre_of_mass = {0, 0.3f, 0};
    f = forces_of(def);
    CHECK(f.gravity.torque.x == Approx(-2 * 0.3 * 2 * 9.80665));
    CHECK(f.total.force == f.gravity.force);
    CHECK(f.buoyancy.force == Vec3f());
}

TEST_CASE("buoyancy is the same 10 km away", "[buoyancy]") {
    const auto map = test::map_of(test::fine_box({0.3, 0.2, 0.5}, 0.2));
    WorldDef high;
    high.level = 1234;
    const Forces near = forces_of(body_of(map, {0, 0, 0.1}, test::turned({1, 1, 0}, 0.4)));
    const Forces far = forces_of(body_of(map, {10000, -10000, 1234.1}, test::turned({1, 1, 0}, 0.4)), high);
    CHECK(length(near.buoyancy.force - far.buoyancy.force) < 1e-5f * length(near.buoyancy.force));
}

TEST_CASE("a body far below the surface is as buoyant as one just below", "[buoyancy]") {
    const auto map = test::map_of(test::fine_box({0.3, 0.2, 0.5}, 0.2));
    for (const double z : {-1.0, -1e3, -1e6, -1e9}) {
        const Forces f = forces_of(body_of(map, {0, 0, z}, test::turned({1, 1, 0}, 0.4)));
        CHECK(static_cast<double>(f.buoyancy.force.z) == Approx(rho_g * 0.03).epsilon(1e-5));
        CHECK(std::fabs(f.buoyancy.force.x) < 1e-3f);
    }
}

TEST_CASE("the wet ratio is the clipped area, without steps", "[buoyancy]") {
    const auto map = test::map_of(test::fine_box({0.2, 0.2, 0.4}, 0.1), 24);
    World world = test::world_of();
    Body& body = world.create_body(body_of(map));
    double before = -1;
    const double whole = 2 * (0.04 + 0.08 + 0.08);
    for (double z = 0.25; z >= -0.25; z -= 0.0005) {
        world.set_motion(body, {{0, 0, z}, test::turned({1, 0.3, 0}, 0.5)}, {});
        world.tick(0.002f);
        double sum = 0;
        for (std::size_t l = 0; l < body.sources.size(); ++l)
            sum += static_cast<double>(body.sources[l].wet_ratio) * static_cast<double>(map->region_area[l]);
        CHECK(sum == Approx(static_cast<double>(body.wet_area)).margin(1e-6));
        if (before >= 0) CHECK(std::fabs(sum - before) < 0.01 * whole);
        before = sum;
    }
    CHECK(before == Approx(whole).epsilon(1e-5));
}

TEST_CASE("each source's wet ratio is its region's clipped area to 0.1 %", "[buoyancy]") {
    const auto map = test::map_of(test::icosphere(0.25, 3), 20);
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    std::uniform_real_distribution<double> depth(-0.26, 0.26);
    for (int i = 0; i < 50; ++i) {
        const BodyDef def = body_of(map, {0, 0, depth(random)},
                                    test::turned({normal(random), normal(random), normal(random)}, normal(random)));
        World world = test::world_of();
        Body& body = world.create_body(def);
        world.tick(0.002f);
        const PlacedMap placed(*map, def);
        for (std::size_t l = 0; l < body.sources.size(); ++l) {
            double wet = 0, all = 0;
            for (std::uint32_t t = map->region_begin[l]; t < map->region_begin[l + 1]; ++t) {
                WaveForce sum;
                add_wet(
                    sum, placed.corners(t), [](const Vec3d&) { return 0.0; }, 0);
                wet += sum.area;
                const auto c = placed.corners(t);
                all += 0.5 * length(cross(c[1] - c[0], c[2] - c[0]));
            }
            const double ratio = wet / all;
            CHECK(std::fabs(static_cast<double>(body.sources[l].wet_ratio) - ratio) < 1e-5);
            if (wet >= all * (1 - 1e-12)) CHECK(body.sources[l].wet_ratio == 1);
            if (wet == 0) CHECK(body.sources[l].wet_ratio == 0);
        }
    }
}

// The tick takes the water as a plane over each cluster of triangles; the reference cuts every triangle into 4^k and takes
// the height at each corner from the formula. 64 cells a wave: of the difference, most is the bilinear height between them.
TEST_CASE("in waves twice as long as the body, buoyancy is right to 0.1 % rms", "[buoyancy]") {
    struct Shape {
        const char* name;
        bake::Surface surface;
        double length;
        int cuts;
    };
    const Shape shapes[] = {{"paddle", test::fine_box({0.2, 0.02, 0.6}, 0.04), 0.6, 2},
                            {"box", test::fine_box({0.3, 0.2, 0.5}, 0.2), 0.5, 4},
                            {"sphere", test::icosphere(0.25, 3), 0.5, 1}};
    for (const Shape& shape : shapes) {
        const auto map = test::map_of(shape.surface, 24);
        const double k = pi / shape.length, amplitude = 0.2 / k;
        const auto cell = static_cast<float>(2 * shape.length / 64);
        constexpr int n = 160;
        World world = test::world_of();
        world.create_water(test::water_of(n, cell, 1.0f));
        std::mt19937 random(5);
        std::normal_distribution<double> normal;
        std::uniform_real_distribution<double> even(-1, 1);
        const double weight = rho_g * map->shape.volume;
        double square = 0, torque_square = 0;
        constexpr int poses = 30;
        for (int i = 0; i < poses; ++i) {
            const double heading = pi * even(random), phase = pi * even(random);
            const double kx = k * std::cos(heading), ky = k * std::sin(heading);
            const auto wave = [&](double x, double y) { return amplitude * std::cos(kx * x + ky * y + phase); };
            std::vector<float> heights;
            for (int j = 0; j < n; ++j)
                for (int q = 0; q < n; ++q)
                    heights.push_back(static_cast<float>(wave((q + 0.5 - n / 2) * static_cast<double>(cell),
                                                              (j + 0.5 - n / 2) * static_cast<double>(cell))));
            world.set_height(heights.data());
            const BodyDef def = body_of(map, {0.013, -0.02, 0.3 * shape.length * even(random)},
                                        test::turned({normal(random), normal(random), normal(random)}, normal(random)));
            Body& body = world.create_body(def);
            world.tick(1e-6f);
            WaveForce exact;
            const PlacedMap placed(*map, def);
            for (std::size_t t = 0; t < map->triangles.size(); ++t)
                add_wet(
                    exact, placed.corners(t), [&](const Vec3d& p) { return wave(p.x, p.y); }, shape.cuts);
            const Vec3d arm = cross(exact.force, def.pose.position);  // torque about the body's origin
            const Vec3d off = Vec3d(body.forces.buoyancy.force) - exact.force * rho_g;
            const Vec3d twist = Vec3d(body.forces.buoyancy.torque) - (exact.torque + arm) * rho_g;
            square += dot(off, off) / (weight * weight);
            torque_square += dot(twist, twist) / (weight * weight * shape.length * shape.length);
            world.destroy_body(body);
        }
        INFO(shape.name << ": rms " << 100 * std::sqrt(square / poses) << " % of rho g V");
        CHECK(std::sqrt(square / poses) < 0.0005);  // measured: 0.0001 to 0.0002
        CHECK(std::sqrt(torque_square / poses) < 0.0005);
    }
}

TEST_CASE("in waves a body becomes dry, and wholly wet, without a jump", "[buoyancy]") {
    // Between its samples a cluster's plane may lie beyond the highest and the lowest water under the body: force jumped by
    // up to 1 % of rho g V, ratios by 0.2.
    const auto map = test::map_of(test::fine_box({0.2, 0.04, 0.3}, 0.05), 12);
    const double whole = rho_g * 0.2 * 0.04 * 0.3;
    constexpr int cells = 96;
    constexpr float cell = 0.0125f;
    struct Felt {
        Vec3d force;
        std::vector<float> ratios;
        bool any, all;
    };
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int n = 0; n < 12; ++n) {
        const double length = n % 2 ? 0.6 : 1.2, k = 2 * pi / length, turn = uniform(random);
        std::vector<float> height;
        for (int j = 0; j < cells; ++j)
            for (int i = 0; i < cells; ++i)
                height.push_back(static_cast<float>(0.2 / k * std::cos(k * cell * i + 3 * turn)));
        const auto rotation = test::turned({1, 0.3 * turn, 0.2}, n % 3 == 0 ? pi / 2 : 3 * uniform(random));
        const auto feel = [&](double z) {
            World world = test::world_of();
            world.create_water(test::water_of(cells, cell, 0.5f));
            world.set_height(height.data());
            Body& body = world.create_body(body_of(map, {0.01 * turn, 0.02, z}, rotation));
            world.tick(1e-6f);
            Felt felt{Vec3d(body.forces.buoyancy.force), {}, false, true};
            for (const SourceState& source : body.sources) {
                felt.ratios.push_back(source.wet_ratio);
                felt.any = felt.any || source.wet_ratio > 0, felt.all = felt.all && source.wet_ratio >= 1;
            }
            return felt;
        };
        for (const bool becomes_dry : {true, false}) {
            double low = becomes_dry ? 0 : -0.35, high = becomes_dry ? 0.35 : 0;
            const auto below = [&](const Felt& felt) { return becomes_dry ? felt.any : felt.all; };
            REQUIRE((below(feel(low)) && !below(feel(high))));
            while (high - low > 1e-7) {
                const double z = 0.5 * (low + high);
                (below(feel(z)) ? low : high) = z;
            }
            const Felt one = feel(low), other = feel(high);
            INFO(n << (becomes_dry ? " dry at " : " whole at ") << low);
            CHECK(frm::length(one.force - other.force) < 1e-4 * whole);
            for (std::size_t l = 0; l < one.ratios.size(); ++l)
                CHECK(std::fabs(one.ratios[l] - other.ratios[l]) < 1e-3f);
        }
    }
}

TEST_CASE("in waves buoyancy is the same 10 km away", "[buoyancy]") {
    const auto map = test::map_of(test::fine_box({0.3, 0.2, 0.5}, 0.05));
    const auto force = [&](double x, double y, double z) {
        WorldDef def;
        def.level = z;
        World world = test::world_of(def);
        WaterDef water_def = test::water_of(96, 0.025f, 1.0f);
        water_def.centre_x = x, water_def.centre_y = y;
        world.create_water(water_def);
        std::vector<float> heights;
        for (int i = 0; i < 96 * 96; ++i) heights.push_back(0.03f * static_cast<float>(std::sin(0.1 * (i % 96))));
        world.set_height(heights.data());
        Body& body = world.create_body(body_of(map, {x + 0.1, y - 0.05, z + 0.1}, test::turned({1, 1, 0}, 0.4)));
        world.tick(0.002f);
        return body.forces.buoyancy;
    };
    const Wrench near = force(0, 0, 0), far = force(10000, -10000, 1234);
    CHECK(length(near.force - far.force) < 1e-5f * length(near.force));
    CHECK(length(near.torque - far.torque) < 1e-5f * length(near.force));
}

TEST_CASE("no water is felt or read lower than the bed", "[buoyancy]") {
    // Linear waves that are higher than the water is deep run lower than its bed.
    const float depth = 0.5f;
    const auto slab = test::map_of(test::fine_box({0.3, 0.3, 0.1}, 0.05), 18);
    for (const float reach : {0.0f, 1e9f}) {  // of the trough in x: under half of the body, and under all of it
        World world = test::world_of();
        Water& water = world.create_water(test::water_of(64, 0.05f, depth));
        Body& in_bed = world.create_body(test::body_of(slab, {0, 0, -0.5}));
        Body& above = world.create_body(test::body_of(slab, {0, 0, -0.44}));
        const float middle = 32;
        for (std::int32_t j = 0; j < 64; ++j)
            for (std::int32_t i = 0; i < 64; ++i)
                water.field.height_row(j)[i] = static_cast<float>(i) < middle + reach ? -2.0f : -depth;
        water.field.wake({0, 0, 64, 64});
        REQUIRE(world.tick(1e-5f));
        INFO("reach " << reach);
        CHECK(in_bed.displaced_volume == Approx(0.3 * 0.3 * 0.05).epsilon(1e-4));
        CHECK(length(in_bed.forces.buoyancy.torque) < 1e-3f);
        CHECK(above.displaced_volume == 0);
        CHECK(water.field.height_at(water.origin_at(-0.5, 0), 0, 0) == -depth);
        std::vector<float> height(water.field.cells());
        copy_to_centres(water.field, height.data(), nullptr, nullptr);
        CHECK(*std::min_element(height.begin(), height.end()) == -depth);
    }
}

TEST_CASE("a hair of a wave changes nothing: one plane or many", "[buoyancy]") {
    const auto map = test::map_of(test::fine_box({0.3, 0.2, 0.5}, 0.05));
    for (const double z : {0.1, -0.05, -0.6}) {
        const auto force = [&](float height) {
            World world = test::world_of();
            world.create_water(test::water_of(96, 0.025f, 1.0f));
            std::vector<float> heights(96 * 96, 0.0f);
            heights[96 * 48 + 48] = height;
            world.set_height(heights.data());
            Body& body = world.create_body(body_of(map, {0.1, -0.05, z}, test::turned({1, 1, 0}, 0.4)));
            world.tick(0.002f);
            return body.forces.buoyancy;
        };
        const Wrench calm = force(0), hair = force(1e-9f);
        CHECK(length(calm.force - hair.force) < 1e-5f * static_cast<float>(rho_g * 0.03));
        CHECK(length(calm.torque - hair.torque) < 1e-5f * static_cast<float>(rho_g * 0.03));
    }
}

TEST_CASE("the wet surface and the footprint are the same bits with every instruction set", "[buoyancy]") {
    const auto map = test::map_of(test::icosphere(0.25, 3), 20);
    const Clusters& clusters = map->clusters;
    std::vector<float> heights;
    for (int i = 0; i < 64 * 64; ++i) heights.push_back(0.05f * static_cast<float>(std::sin(0.37 * i)));
    const HeightGrid grid{heights.data(), 64, 64, 64, 0.001f};
    const GridPlacement at{30, 31, 0.3f, 0.7f, {19, 3, 5}, {-3, 19, 4}};
    const BodyLevel level{0.03f, {0.1f, -0.3f, 0.949f}, 1};
    constexpr int levels = 5;
    const VolumeElements elements(*map, 0.05f, levels, test::memory());
    const auto run = [&](const Kernels& kernel) {
        std::vector<float> out;
        const auto keep = [&](const auto& value) {
            const std::size_t at_end = out.size();
            out.resize(at_end + sizeof value / sizeof(float));
            std::memcpy(out.data() + at_end, &value, sizeof value);
        };
        WetLanes sum{}, clips{};
        for (const auto& block : clusters.blocks) {
            float samples[4 * kernel_lanes];
            ClusterPlanes planes{};
            kernel.sample_heights(&grid, &at, block.point[0][0], block.point[1][0], block.point[2][0], 4 * kernel_lanes,
                                  samples);
            kernel.measure_clusters(&block, &level, samples, &planes, &sum);
            keep(samples), keep(planes);
        }
        std::uint32_t cut = 0;
        float area[kernel_lanes] = {};
        for (const auto& batch : clusters.batches)
            cut += kernel.clip_triangles(&batch, 0.02f, -0.1f, 0.3f, -0.949f, &clips, area);
        CHECK(cut > 10);
        keep(sum), keep(clips), keep(area), keep(cut);
        float range[3];
        kernel.height_range(heights.data() + 5, 64, 37, 60, range, range + 1, range + 2);
        keep(range);
        for (int k = 0; k < levels; ++k) {
            const SliceLevel slice{static_cast<float>(1 << k), k == levels - 1 ? 1.0f : 0.0f, k == 0 ? 1.0f : 0.0f, 1,
                                   50};
            for (const auto& block : elements.at(k)) {
                float laid[kernel_lanes], left[kernel_lanes];
                kernel.slice_elements(&block.element, &slice, 0.1f, 0.1f, -0.3f, 0.949f, laid, left);
                keep(laid), keep(left);
            }
        }
        float fine[8 * 32] = {};
        kernel.refine(fine + 32, 32, heights.data() + 16, 24, 3, 2);
        kernel.add_change_row(fine, heights.data() + 1, heights.data() + 11, 77);
        keep(fine);
        keep(kernel.pressed_divergence(heights.data() + 3, 64, heights.data() + 70, heights.data() + 140, 64, 20, 43));
        return out;
    };
    const Kernels* sets[max_kernel_sets];
    const std::size_t count = every_kernel_set(sets);
    const std::vector<float> baseline = run(*sets[0]);
    for (std::size_t i = 1; i < count; ++i) {
        const std::vector<float> other = run(*sets[i]);
        INFO(sets[i]->instructions);
        CHECK(std::memcmp(baseline.data(), other.data(), baseline.size() * sizeof(float)) == 0);
    }
}

TEST_CASE("a fluid without a surface has no buoyancy and wets everything", "[buoyancy]") {
    WorldDef air;
    air.everywhere = true;
    air.fluid = {9.80665f, 1.2f, 1.5e-5f};
    const auto map = test::map_of(test::fine_box({0.2, 0.2, 0.4}, 0.2));
    World world = test::world_of(air);
    Body& body = world.create_body(body_of(map, {0, 0, 100}));
    world.tick(0.01f);
    CHECK(length(body.forces.buoyancy.force) == 0);
    CHECK(body.wet_sources == map->source_count());
    for (const SourceState& s : body.sources) CHECK(s.wet_ratio == 1);
}
