// Buoyancy and weight against exact answers.
#include <cmath>
#include <random>

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
