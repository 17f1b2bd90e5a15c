// Eqs. 7, 8 and 10 against exact answers of linear shallow water.
#include <cmath>

#include "core/error.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;

namespace {

constexpr double g = 9.80665;
constexpr double pi = 3.14159265358979323846;

double volume(const Field& f) {
    double sum = 0;
    for (std::int32_t j = 0; j < f.def().ny; ++j)
        for (std::int32_t i = 0; i < f.def().nx; ++i) sum += static_cast<double>(f.height_row(j)[i] + f.level());
    return sum * static_cast<double>(f.def().cell * f.def().cell);
}

/// Potential and kinetic energy per unit of density.
double energy(const Field& f) {
    double h = 0, u = 0;
    const auto square = [](float v) { return static_cast<double>(v) * static_cast<double>(v); };
    const std::int32_t nx = f.def().nx, ny = f.def().ny;
    for (std::int32_t j = 0; j < ny; ++j) {
        for (std::int32_t i = 0; i < nx; ++i) h += square(f.height_row(j)[i]);
        for (std::int32_t i = 0; i <= nx; ++i) u += square(f.velocity_x_row(j)[i]);
    }
    for (std::int32_t j = 0; j <= ny; ++j)
        for (std::int32_t i = 0; i < nx; ++i) u += square(f.velocity_y_row(j)[i]);
    return 0.5 * static_cast<double>(f.def().cell * f.def().cell) * (g * h + static_cast<double>(f.def().depth) * u);
}

std::vector<float> bump(std::int32_t n, double x, double y, double width, double height) {
    std::vector<float> h;
    for (std::int32_t j = 0; j < n; ++j)
        for (std::int32_t i = 0; i < n; ++i)
            h.push_back(
                static_cast<float>(height * std::exp(-((i - x) * (i - x) + (j - y) * (j - y)) / (2 * width * width))));
    return h;
}

}  // namespace

TEST_CASE("a standing wave has the period of the basin's mode", "[waves]") {
    const std::int32_t n = 64;
    const float cell = 0.05f, depth = 0.4f;
    World world = test::world_of();
    Water& water = world.create_water(test::water_of(n, cell, depth, Border::reflecting));
    const int mode = 4;  // 32 cells a wavelength
    std::vector<float> h;
    for (std::int32_t j = 0; j < n; ++j)
        for (std::int32_t i = 0; i < n; ++i)
            h.push_back(static_cast<float>(0.01 * std::cos(pi * mode * (i + 0.5) / n)));
    world.set_height(h.data());
    const double wavelength = 2.0 * n * static_cast<double>(cell) / mode;
    const double period = wavelength / std::sqrt(g * static_cast<double>(depth));
    const float dt = 0.002f;
    std::vector<double> crossings;
    float before = water.field.height_row(0)[0];
    for (int t = 1; crossings.size() < 21; ++t) {
        world.tick(dt);
        const float now = water.field.height_row(0)[0];
        if ((before > 0) != (now > 0))
            crossings.push_back((t - 1 + static_cast<double>(before / (before - now))) * static_cast<double>(dt));
        before = now;
    }
    const double measured = (crossings.back() - crossings.front()) / 10;
    CHECK(measured == Approx(period).epsilon(0.002));  // second order: (k dx)^2 / 24 = 0.16 % slow at 32 cells
    CHECK(measured > period);
    // No numerical damping: the amplitude after ten periods is what it was.
    float largest = 0;
    for (int t = 0; t < 400; ++t) {
        world.tick(dt);
        largest = std::fmax(largest, std::fabs(water.field.height_row(0)[0]));
    }
    const float corner = h[0];
    CHECK(largest == Approx(corner).epsilon(2e-3));
}

TEST_CASE("a pulse runs at sqrt(g d)", "[waves]") {
    const std::int32_t n = 256;
    const float cell = 0.02f, depth = 0.6f;
    World world = test::world_of();
    Water& water = world.create_water(test::water_of(n, cell, depth, Border::reflecting));
    std::vector<float> h;
    for (std::int32_t j = 0; j < n; ++j)
        for (std::int32_t i = 0; i < n; ++i)
            h.push_back(static_cast<float>(0.02 * std::exp(-0.5 * std::pow((i - 60.0) / 12, 2))));
    world.set_height(h.data());
    const double speed = std::sqrt(g * static_cast<double>(depth));
    const int ticks = 500;
    for (int t = 0; t < ticks; ++t) world.tick(0.002f);
    // Half of the pulse runs each way; the right one's centroid.
    double sum = 0, moment = 0;
    for (std::int32_t i = 110; i < n; ++i) {
        const double v = static_cast<double>(water.field.height_row(128)[i]);
        sum += v, moment += v * i;
    }
    const double travelled = (moment / sum - 60) * static_cast<double>(cell);
    CHECK(travelled == Approx(speed * ticks * 0.002).epsilon(0.003));
}

TEST_CASE("a pressure held still raises the water by p / (rho g)", "[waves]") {
    const std::int32_t n = 96;
    World world = test::world_of();
    Water& water = world.create_water(test::water_of(n, 0.05f, 0.5f, Border::absorbing, 16));
    std::vector<float> p = bump(n, 48, 48, 6, 200);
    world.set_pressure(p.data());
    for (int t = 0; t < 8000; ++t) world.tick(0.002f);
    double worst = 0;
    for (std::int32_t j = 30; j < 66; ++j)
        for (std::int32_t i = 30; i < 66; ++i) {
            const std::size_t at = static_cast<std::size_t>(j * n + i);
            worst = std::fmax(worst, std::fabs(static_cast<double>(water.field.height_row(j)[i]) -
                                               static_cast<double>(p[at]) / (1000 * g)));
        }
    CHECK(worst < 1e-3 * 200 / (1000 * g));
    world.set_pressure(nullptr);
    for (int t = 0; t < 8000; ++t) world.tick(0.002f);
    CHECK(std::fabs(water.field.height_row(48)[48]) < 1e-5f);
}

TEST_CASE("a closed basin keeps its volume and its energy", "[waves]") {
    const std::int32_t n = 48;
    World world = test::world_of();
    Water& water = world.create_water(test::water_of(n, 0.05f, 0.5f, Border::reflecting));
    world.set_height(bump(n, 15, 30, 4, 0.05).data());
    const double before = volume(water.field), energy_before = energy(water.field);
    double highest = 0, lowest = 1e9;
    for (int t = 0; t < 20000; ++t) {
        world.tick(0.004f);
        if (t % 50 == 0)
            highest = std::fmax(highest, energy(water.field)), lowest = std::fmin(lowest, energy(water.field));
    }
    CHECK(volume(water.field) == Approx(before).epsilon(1e-5));
    // The leapfrog step keeps an energy that differs from this one by the Courant number's share, so it swings but
    // does not drift.
    CHECK(energy(water.field) == Approx(energy_before).epsilon(0.03));
    CHECK(highest < 1.05 * energy_before);
    CHECK(lowest > 0.95 * energy_before);
}

TEST_CASE("an open border lets a pulse go", "[waves]") {
    const std::int32_t n = 128;
    World world = test::world_of();
    Water& water = world.create_water(test::water_of(n, 0.05f, 0.5f, Border::absorbing, 16));
    world.set_height(bump(n, 64, 64, 4, 0.05).data());
    world.tick(0.002f);
    const double before = energy(water.field);
    // The front needs 1.4 s to the border and as long back; 3.5 s is after the reflection has crossed the middle.
    for (int t = 0; t < 1750; ++t) world.tick(0.002f);
    CHECK(energy(water.field) < 0.01 * before);
}

TEST_CASE("steps are divided where the grid asks for it, with the same result", "[waves]") {
    const std::int32_t n = 64;
    const auto run = [&](float dt, int ticks) {
        World world = test::world_of();
        Water& water = world.create_water(test::water_of(n, 0.02f, 0.5f, Border::reflecting));
        world.set_height(bump(n, 32, 32, 6, 0.01).data());
        for (int t = 0; t < ticks; ++t) world.tick(dt);
        std::vector<float> heights(water.field.cells());
        water.field.copy_heights(heights.data());
        return std::pair(heights, world.substeps());
    };
    const auto [fine, one] = run(0.005f, 60);
    const auto [coarse, many] = run(0.1f, 3);
    CHECK(one == 1);
    CHECK(many >= 17);
    float worst = 0;
    for (std::size_t i = 0; i < fine.size(); ++i) worst = std::fmax(worst, std::fabs(fine[i] - coarse[i]));
    CHECK(worst < 2e-4f);
    World world = test::world_of();
    world.create_water(test::water_of(64, 0.0001f, 5000, Border::reflecting));
    const std::uint64_t hash = world.hash();
    CHECK_THROWS_AS(world.tick(0.1f), Error);
    CHECK(world.hash() == hash);
}

TEST_CASE("threads do not change a bit of large water", "[waves]") {
    const auto run = [](std::uint32_t threads) {
        World world = test::world_of({}, threads);
        world.create_water(test::water_of(544, 0.05f, 0.5f));
        world.set_height(bump(544, 200, 300, 10, 0.1).data());
        for (int t = 0; t < 30; ++t) world.tick(0.004f);
        return world.hash();
    };
    const std::uint64_t one = run(1);
    CHECK(run(2) == one);
    CHECK(run(3) == one);
}

TEST_CASE("a window's contents move by whole cells", "[waves]") {
    const std::int32_t n = 5;
    std::vector<float> data;
    for (int i = 0; i < n * n; ++i) data.push_back(static_cast<float>(i + 1));
    for (const auto& [di, dj] :
         {std::pair(1, 0), std::pair(-2, 1), std::pair(0, -3), std::pair(2, 2), std::pair(7, 0)}) {
        std::vector<float> moved = data;
        shift_array(moved.data(), n, n, n, di, dj);
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const int fi = i + di, fj = j + dj;
                const float expected =
                    fi < 0 || fj < 0 || fi >= n || fj >= n ? 0.0f : data[static_cast<std::size_t>(fj * n + fi)];
                CHECK(moved[static_cast<std::size_t>(j * n + i)] == expected);
            }
    }
}
