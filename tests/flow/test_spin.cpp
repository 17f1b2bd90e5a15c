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
