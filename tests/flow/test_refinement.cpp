// Blocks of different cells against an exact flow that goes through them.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "bake/flow/blocks.h"
#include "bake/flow/kernel.h"
#include "bake/flow/nest.h"
#include "tests/support/catch.h"

using namespace frm;
using namespace frm::bake;
using namespace frm::bake::flow;

namespace {

/// A box of nested blocks without a body, the fluid moving along x.
Domain empty_nest(bool section, double size) {
    Domain d;
    BlockRequest request;
    request.low = {-0.5 * size, -0.5 * size, section ? 0.0 : -0.5 * size};
    request.high = request.low * -1.0;
    request.bulk = size;
    request.section = section;
    d.blocks = plan_blocks(request);
    d.plan.cell = 1;
    d.lattice_speed = d.stream_speed = 0.1;
    d.ramp_steps = 1;
    d.first_step = std::uint64_t{1} << (d.blocks.size() - 1);
    d.sponge = 0.1 * d.blocks.back().grid.nx;
    return d;
}

/// Taylor's vortex: no circulation, an exact solution: u = (speed at r = width) r / width exp((1 - (r / width)^2) / 2)
/// with width^2 = width0^2 + 2 nu t, the speed falling as width^-3.
struct Vortex {
    double speed, width0, viscosity;
    double x, y;

    double width(double t) const { return std::sqrt(width0 * width0 + 2 * viscosity * t); }
    double peak(double t) const { return speed * std::pow(width0 / width(t), 3); }
    /// Velocity beside the stream's.
    Vec3d at(const Vec3d& p, double t, double stream) const {
        const double dx = p.x - x - stream * t, dy = p.y - y, w = width(t);
        const double share = peak(t) / w * std::exp(0.5 * (1 - (dx * dx + dy * dy) / (w * w)));
        return {-dy * share, dx * share, 0};
    }
    /// Pressure over density, from the balance with the centrifugal force.
    double pressure(const Vec3d& p, double t, double stream) const {
        const double dx = p.x - x - stream * t, dy = p.y - y, w = width(t), u = peak(t);
        return -0.5 * u * u * std::exp(1 - (dx * dx + dy * dy) / (w * w));
    }
};

}  // namespace

TEST_CASE("what is kept of a row while it collides is what is observed of it", "[flow]") {
    const Grid one_chunk{77, 3, 3, false}, two_chunks{141, 3, 3, false};
    for (const Grid& g : {one_chunk, two_chunks}) {
        Populations from(g), to(g), plain(g);
        std::uint32_t random = 1;
        for (int i = 0; i < direction_count; ++i) {
            for (std::size_t cell = 0; cell < g.allocated(); ++cell) {
                random = random * 1664525 + 1013904223;
                from.at(i)[cell] = weight(i) * 0.2f * (static_cast<float>(random >> 8) / 8388608 - 1);
            }
        }
        // Of a sponge's cells with the time of their own.
        const int first = g.nx - 15;
        std::vector<float> times(g.pitch(), 0.503f);
        std::fill_n(times.begin() + first, 5, 0.6f);
        Collision collision;
        collision.relaxation = times.data();
        collision.smagorinsky = 0.01f;
        collision.push[0] = 0.001f;
        const std::size_t row = 4;
        const auto width = static_cast<std::size_t>(g.nx);
        std::vector<float> observed(field_count * width), whole(field_count * width), in_sponge(field_count * 5),
            part(field_count * 5);
        const auto rows_of = [](std::vector<float>& memory, std::size_t size) {
            Fields fields{};
            for (std::size_t f = 0; f < field_count; ++f) fields[f] = memory.data() + f * size;
            return fields;
        };
        observe(g, from, 0, 1, 1, width, 0.503f, 0.01f, rows_of(observed, width));
        observe(g, from, first, 1, 1, 5, 0.6f, 0.01f, rows_of(in_sponge, 5));
        REQUIRE(in_sponge[4 * 5] != observed[4 * width + static_cast<std::size_t>(first)]);
        Wanted wanted;
        wanted.add(0, g.nx, rows_of(whole, width));
        wanted.add(first, 5, rows_of(part, 5));
        collide_row(g, from, to, row, collision, wanted);
        CHECK(part == in_sponge);
        for (std::size_t f = 0; f < field_count; ++f)
            std::copy_n(in_sponge.begin() + static_cast<std::ptrdiff_t>(5 * f), 5,
                        observed.begin() + static_cast<std::ptrdiff_t>(f * width) + first);
        CHECK(whole == observed);
        collide_row(g, from, plain, row, collision, {});
        for (int i = 0; i < direction_count; ++i) {
            const std::size_t begin = g.row(row);
            CHECK(std::equal(to.at(i) + begin, to.at(i) + begin + g.nx, plain.at(i) + begin));
        }
    }
}

TEST_CASE("a vortex goes through blocks of other cells as if they were not there", "[flow]") {
    Domain d = empty_nest(true, 24);
    REQUIRE(d.levels() >= 4);
    d.viscosity = 0.002;
    Wall wall({}, 1, 0);
    Nest nest(d, {}, wall, 2);
    const Vec3d middle = Vec3d{0, 0, 0};
    // From ahead of the second block, through the finest, to behind both.
    const Block& finest = d.blocks[0];
    const double ahead = 2.0 * (2 * finest.first[0] - 40);
    Vortex vortex{0.03, 24, d.viscosity, ahead * 0.5, 5.3};
    nest.set([&](const Vec3d& p, std::array<float, field_count>& f) {
        const Vec3d u = vortex.at(p - middle, 0, 0.1);
        constexpr double step = 1e-3;
        f.fill(0);
        f[0] = static_cast<float>(3 * vortex.pressure(p, 0, 0.1));
        f[1] = static_cast<float>(0.1 + u.x);
        f[2] = static_cast<float>(u.y);
        const Vec3d ux =
            (vortex.at(p + Vec3d{step, 0, 0}, 0, 0.1) - vortex.at(p - Vec3d{step, 0, 0}, 0, 0.1)) / (2 * step);
        const Vec3d uy =
            (vortex.at(p + Vec3d{0, step, 0}, 0, 0.1) - vortex.at(p - Vec3d{0, step, 0}, 0, 0.1)) / (2 * step);
        // Stress over relaxation time is -2/3 of the rate of strain.
        f[4] = static_cast<float>(-2.0 / 3 * ux.x);
        f[5] = static_cast<float>(-2.0 / 3 * uy.y);
        f[7] = static_cast<float>(-1.0 / 3 * (ux.y + uy.x));
    });
    const std::uint64_t begin = nest.step();
    const double distance = -2 * vortex.x;
    double worst = 0;
    int looks = 0;
    while (static_cast<double>(nest.step() - begin) * 0.1 < distance) {
        nest.advance([](std::uint64_t) {});
        const auto t = static_cast<double>(nest.step() - begin);
        if (nest.step() % 256 != 0) continue;
        double error = 0;
        for (int i = -40; i <= 40; i += 4) {
            for (int j = -40; j <= 40; j += 4) {
                const Vec3d p{4 * std::round((vortex.x + 0.1 * t + i) / 4), 4 * std::round((vortex.y + j) / 4), 0};
                std::array<float, field_count> f{};
                REQUIRE(nest.sample(p, f));
                const Vec3d u = vortex.at(p, t, 0.1);
                error = std::max({error, std::abs(static_cast<double>(f[1]) - 0.1 - u.x),
                                  std::abs(static_cast<double>(f[2]) - u.y)});
            }
        }
        ++looks;
        worst = std::max(worst, error / vortex.peak(t));
    }
    CHECK(looks > 4);
    CHECK(worst < 0.05);
}
