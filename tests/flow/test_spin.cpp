// Bodies that turn in still water, solved in the frame that turns with them.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "bake/flow/blocks.h"
#include "bake/flow/flow.h"
#include "bake/flow/nest.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;
using namespace frm::bake::flow;

namespace {

/// Blocks without a body that turn about an axis between nodes, the fluid everywhere at rest seen from outside.
Domain turning_nest(double radius, double rate) {
    Domain d;
    BlockRequest request;
    request.low = {-0.7 * radius, -0.2 * radius, -0.3 * radius};
    request.high = {0.7 * radius, 0.3 * radius, 0.3 * radius};
    request.bulk = radius;
    request.radius = radius;
    request.axis = {0.3, -0.4, 0};
    d.blocks = plan_blocks(request);
    d.plan.cell = 1;
    d.turning = true;
    d.spin = {0, 0, rate};
    d.spin_centre = request.axis - d.node(0, 0, 0, 0);
    d.lattice_speed = rate * radius;
    d.viscosity = 0.002;
    d.ramp_steps = 1;
    d.first_step = std::uint64_t{2} << (d.blocks.size() - 1);  // the ramp is over in all blocks
    d.sponge = 3;
    d.reach = 3.4 * radius;
    return d;
}

struct Deviation {
    double speed = 0, pressure = 0;  // shares of the speed at the radius, and of density times its square
    bool missing = false;
};

/// The largest departure from water at rest anywhere.
Deviation deviation(const Domain& d, const Nest& nest) {
    Deviation worst;
    const Block& outer = d.blocks.back();
    for (int k = 0; k < outer.grid.nz; ++k) {
        for (int j = 0; j < outer.grid.ny; ++j) {
            for (int i = 0; i < outer.grid.nx; ++i) {
                const Vec3d p = d.node(d.levels() - 1, i, j, k);
                std::array<float, field_count> f{};
                if (!nest.sample(p, f)) worst.missing = true;
                const Vec3d arm = p - d.node(0, 0, 0, 0) - d.spin_centre, far = cross(d.spin, arm);
                const Vec3d u{static_cast<double>(f[1]), static_cast<double>(f[2]), static_cast<double>(f[3])};
                worst.speed = std::max(worst.speed, length(u + far));
                worst.pressure = std::max(worst.pressure, std::abs(static_cast<double>(f[0])));
            }
        }
    }
    worst.speed /= d.lattice_speed;
    worst.pressure /= 3 * d.lattice_speed * d.lattice_speed;
    return worst;
}

/// The fastest point at 1 m/s, density 1; Reynolds number w R^2 / nu.
FlowCase spinning(double radius, double reynolds, double cells, double start_up, double duration) {
    FlowCase c;
    c.direction = {1, 0, 0};
    c.speed = 0;
    c.density = 1;
    c.spin = {0, 0, 1 / radius};
    c.viscosity = radius / reynolds;
    c.resolution = cells;
    c.start_up = start_up;
    c.duration = duration;
    return c;
}

Vec3d mean(const std::vector<float>& values) {
    Vec3d sum;
    for (std::size_t i = 0; i < values.size(); ++i) sum[static_cast<int>(i % 3)] += static_cast<double>(values[i]);
    return values.empty() ? sum : sum * (3.0 / static_cast<double>(values.size()));
}

FlowSeries solve(const Surface& surface, const FlowCase& c) {
    Regions regions;
    regions.region.assign(surface.triangles.size(), 0);
    regions.count = 1;
    return solve_flow(surface, regions, c, nullptr);
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

std::string error_of(const Surface& surface, const FlowCase& c) {
    try {
        plan_flow(surface, c);
    } catch (const BakeError& e) {
        return e.what();
    }
    return {};
}

}  // namespace

TEST_CASE("water at rest stays so in a frame that turns, through blocks of other cells", "[flow]") {
    const Domain d = turning_nest(24, 0.045 / 24);
    REQUIRE(d.levels() >= 3);
    Wall wall({}, 1, 0);
    Nest nest(d, {}, wall, 2);
    nest.set([&](const Vec3d& p, std::array<float, field_count>& f) {
        const Vec3d u = cross(d.spin, p - d.node(0, 0, 0, 0) - d.spin_centre) * -1.0;
        f.fill(0);
        f[1] = static_cast<float>(u.x);
        f[2] = static_cast<float>(u.y);
    });
    const std::uint64_t begin = nest.step();
    while (nest.step() < begin + 3000) nest.advance([](std::uint64_t) {});
    const Deviation worst = deviation(d, nest);
    CHECK_FALSE(worst.missing);
    CHECK(worst.speed < 8e-4);
    CHECK(worst.pressure < 8e-3);
}

TEST_CASE("water at rest stays so while the frame starts to turn", "[flow]") {
    Domain d = turning_nest(24, 0.045 / 24);
    d.ramp_steps = 600;
    Wall wall({}, 1, 0);
    Nest nest(d, {}, wall, 2);
    while (nest.step() < 1200) nest.advance([](std::uint64_t) {});
    const Deviation worst = deviation(d, nest);
    CHECK_FALSE(worst.missing);
    CHECK(worst.speed < 8e-3);
    CHECK(worst.pressure < 0.03);
}

// Dennis, Singh and Ingham 1980, J. Fluid Mech. 101: 2 T / (rho w^2 a^5) = 6.45 Re^-1/2 + 32.1 / Re.
TEST_CASE("a sphere feels the same torque from the frame that turns as from a wall that moves", "[flow]") {
    const Surface sphere = test::icosphere(0.5, 4);
    FlowCase c = spinning(0.5, 100, 12, 10, 2);
    const auto coefficient = [&] { return -2 * mean(solve(sphere, c).torque).z / (4 * std::pow(0.5, 5)); };
    const double wall = coefficient();
    c.turning = true;
    const double turning = coefficient();
    CHECK(turning == Approx(wall).epsilon(0.04));
    CHECK(turning == Approx(6.45 / std::sqrt(100.0) + 32.1 / 100).epsilon(0.06));
}

TEST_CASE("a prism that turns feels one torque whichever way it goes and the lattice lies", "[flow]") {
    const Surface prism = test::box({1, 1, 1});
    FlowCase c = spinning(std::sqrt(0.5), 300, 16, 8, 3);
    const FlowSeries forward = solve(prism, c);
    const double torque = mean(forward.torque).z;
    CHECK(torque < 0);
    CHECK(std::abs(mean(forward.torque).x) < -0.01 * torque);
    CHECK(length(mean(forward.pressure) + mean(forward.friction)) < -0.05 * torque);
    c.spin.z = -c.spin.z;
    CHECK(mean(solve(prism, c).torque).z == Approx(-torque).epsilon(0.01));
    c.turn = 30;
    CHECK(mean(solve(prism, c).torque).z == Approx(-torque).epsilon(0.03));
}

TEST_CASE("a plate that turns has the same bits for any number of threads", "[flow]") {
    const Surface plate = test::rotated(test::box({0.2, 1, 1.5}), {1, 2, 3}, 0.4);
    Regions regions;
    regions.count = 12;
    for (std::uint32_t t = 0; t < 12; ++t) regions.region.push_back(t);
    FlowCase c = spinning(0.9, 5000, 22, 1, 0.5);
    c.spin_centre = {0.1, 0.2, 0};
    c.threads = 1;
    const FlowSeries one = solve_flow(plate, regions, c, nullptr);
    CHECK(one.plan.blocks.size() > 1);
    for (const int threads : {2, 3}) {
        c.threads = threads;
        const FlowSeries many = solve_flow(plate, regions, c, nullptr);
        CHECK(same_bits(one.pressure, many.pressure));
        CHECK(same_bits(one.friction, many.friction));
        CHECK(same_bits(one.torque, many.torque));
    }
}

TEST_CASE("a body that turns is refused in a stream", "[flow]") {
    const Surface box = test::box({1, 1, 1});
    FlowCase c = spinning(0.8, 100, 8, 1, 1);
    CHECK(error_of(box, c).empty());
    c.speed = 0.1;
    CHECK(error_of(box, c).find("set speed to 0") != std::string::npos);
    c.turning = true;
    CHECK(error_of(test::icosphere(0.5, 3), c).find("turning") != std::string::npos);
}
