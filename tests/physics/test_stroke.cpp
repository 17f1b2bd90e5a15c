// What a stroke leaves in the water (the ghost current), and what it costs: the work that bodies and pressure do on the
// water is the energy that its waves gain.
#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;
using test::body_of;

namespace {

constexpr float gravity = 9.80665f, density = 1000;

float fastest(const Field& f) {
    float most = 0;
    for (std::int32_t j = 0; j < f.def().ny; ++j)
        for (std::int32_t i = 0; i < f.def().nx; ++i)
            most = std::max({most, std::fabs(f.velocity_x_row(j)[i]), std::fabs(f.velocity_y_row(j)[i])});
    return most;
}

/// The largest speed of the water 2 s after a plate was drawn half a metre through it at 0.5 m/s and taken out, as a
/// share of that speed.
float left_after_a_stroke(std::uint32_t model) {
    const float speed = 0.5f;
    WorldDef def;
    def.model = model;
    World world = test::world_of(def);
    Water& water = world.create_water(test::water_of(128, 0.025f, 0.5f));
    Body& body =
        world.create_body(body_of(test::map_of(test::fine_box({0.05, 0.3, 0.3}, 0.05), 12, 2, 16), {-0.25, 0, 0}));
    for (int t = 0; t < 500; ++t) {
        world.set_motion(body, {{-0.25 + 0.001 * t, 0, 0}, {}}, {{speed, 0, 0}, {}});
        world.tick(0.002f);
    }
    world.set_motion(body, {{0.25, 0, 2}, {}}, {});
    for (int t = 0; t < 1000; ++t) world.tick(0.002f);
    return fastest(water.field) / speed;
}

/// Of the waves, J, as the leapfrog step keeps it: of the heights between two half steps, and both half steps'
/// velocities.
double energy(const Field& f, const std::vector<float>& height, const std::vector<float>& before,
              const std::vector<float>& after) {
    double potential = 0, kinetic = 0;
    for (const float h : height) potential += static_cast<double>(h) * static_cast<double>(h);
    for (std::size_t k = 0; k < before.size(); ++k)
        kinetic += static_cast<double>(before[k]) * static_cast<double>(after[k]);
    const double area = static_cast<double>(f.def().cell) * static_cast<double>(f.def().cell);
    return 0.5 * static_cast<double>(density) * area *
           (static_cast<double>(gravity) * potential + static_cast<double>(f.def().depth) * kinetic);
}

std::vector<float> velocities(const Field& f) {
    std::vector<float> out;
    for (std::int32_t j = 0; j < f.def().ny; ++j)
        for (std::int32_t i = 0; i < f.def().nx; ++i)
            out.insert(out.end(), {f.velocity_x_row(j)[i], f.velocity_y_row(j)[i]});
    return out;
}

}  // namespace

TEST_CASE("2 s after a stroke under 5 % of its speed is left; the paper's rule leaves nearly all", "[stroke]") {
    const float repaired = left_after_a_stroke(model_default), paper = left_after_a_stroke(model_paper);
    INFO("repaired " << repaired << ", paper " << paper);
    CHECK(repaired < 0.05f);
    CHECK(paper > 0.9f);
}

TEST_CASE("the work that a pressure does on a closed basin is the energy that its waves gain", "[stroke]") {
    const std::int32_t n = 64;
    WorldDef def;
    def.skip = skip_nothing;
    World world = test::world_of(def);
    Water& water = world.create_water(test::water_of(n, 0.05f, 0.5f, Border::reflecting));
    std::vector<float> pressure(static_cast<std::size_t>(n) * n), height(pressure.size()), next(pressure.size());
    std::vector<double> rise(pressure.size(), 0.0);
    double work = 0;
    const float dt = 0.004f;
    for (int t = 0; t < 1000; ++t) {
        // Stirs for 3 s, softly on and off.
        const double phase = 0.004 * t, level = phase < 3 ? std::pow(std::sin(M_PI * phase / 3), 2) : 0.0;
        for (std::int32_t j = 0; j < n; ++j)
            for (std::int32_t i = 0; i < n; ++i) {
                const double x = 0.15 * (i - 20 - 8 * std::sin(2 * phase)), y = 0.15 * (j - 40);
                const auto k = static_cast<std::size_t>(j * n + i);
                const auto p = static_cast<float>(60 * level * std::sin(7 * phase) * std::exp(-x * x - y * y));
                // p dV, with what was before and after the rise: a pressure acts between two half steps.
                work += 0.5 * static_cast<double>(pressure[k] + p) * rise[k] * 0.05 * 0.05;
                pressure[k] = p;
            }
        world.set_pressure(pressure.data());
        water.field.copy_heights(height.data());
        world.tick(dt);
        water.field.copy_heights(next.data());
        for (std::size_t k = 0; k < next.size(); ++k)
            rise[k] = static_cast<double>(next[k]) - static_cast<double>(height[k]);
    }
    world.set_pressure(nullptr);
    water.field.copy_heights(height.data());
    const std::vector<float> before = velocities(water.field);
    world.tick(dt);
    const double gained = energy(water.field, height, before, velocities(water.field));
    INFO("work " << work << " J, gained " << gained << " J");
    CHECK(work > 0.01);
    CHECK(gained == Approx(work).epsilon(0.001));
}

// What a body displaces lifts water against its own head: with dT of thickness added to h, rho g dT (h + dT / 2), and half
// of that h as it was a step before, because velocities lie between. What it presses is p dV, as above.
TEST_CASE("the work that a body does on a closed basin is the energy that its waves gain", "[stroke]") {
    const std::int32_t n = 96;
    const double area = 0.05 * 0.05, weight = static_cast<double>(density) * static_cast<double>(gravity);
    World world = test::world_of();
    Water& water = world.create_water(test::water_of(n, 0.05f, 0.5f, Border::reflecting));
    Body& body =
        world.create_body(body_of(test::map_of(test::fine_box({0.4, 0.3, 0.1}, 0.05), 18, 2, 16), {0.3, -0.2, 0}));
    const auto size = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
    const auto place = [&](const float* window, std::vector<float>& out) {
        const Footprint& f = *body.footprint;
        std::fill(out.begin(), out.end(), 0.0f);
        for (std::int32_t j = 0; j < f.size(); ++j)
            for (std::int32_t i = 0; i < f.size(); ++i) {
                const std::int32_t wi = i + f.i0(), wj = j + f.j0();
                const float value = window[j * f.size() + i];
                if (wi >= 0 && wj >= 0 && wi < n && wj < n) out[static_cast<std::size_t>(wj * n + wi)] = value;
            }
    };
    std::vector<float> height(size), next(size), thickness(size), thicker(size), pressure(size), pressed(size);
    std::vector<double> displaced(size, 0.0), rise(size, 0.0);
    world.tick(0.004f);
    place(body.footprint->thickness_before_row(0), thickness);
    double lifted = 0, pushed = 0;
    for (int t = 0; t < 1000; ++t) {
        const double phase = 0.004 * t, level = phase < 3 ? std::pow(std::sin(M_PI * phase / 3), 2) : 0.0;
        const auto heave = static_cast<float>(0.03 * level * std::sin(9 * phase));
        const float speed = t < 750 ? 0.3f * static_cast<float>(level * std::cos(9 * phase)) : 0.0f;
        world.set_motion(body, {{0.3, -0.2, heave}, test::turned({1, 0, 0}, 2 * static_cast<double>(heave))},
                         {{0, 0, speed}, {}});
        water.field.copy_heights(height.data());
        world.tick(0.004f);
        water.field.copy_heights(next.data());
        place(body.footprint->thickness_before_row(0), thicker);
        place(body.footprint->pressure(), pressed);
        for (std::size_t k = 0; k < size; ++k) {
            pushed += 0.5 * static_cast<double>(pressure[k] + pressed[k]) * rise[k] * area;
            const double h = static_cast<double>(height[k]),
                         dt = static_cast<double>(thicker[k]) - static_cast<double>(thickness[k]);
            lifted += weight * area * dt * 0.5 * (h + dt + (t > 0 ? displaced[k] : h));
            displaced[k] = h + dt;
            rise[k] = static_cast<double>(next[k]) - displaced[k];
        }
        std::swap(thickness, thicker);
        std::swap(pressure, pressed);
    }
    REQUIRE(water.field.level() == 0);
    water.field.copy_heights(height.data());
    const std::vector<float> before = velocities(water.field);
    world.tick(0.004f);
    const double gained = energy(water.field, height, before, velocities(water.field));
    INFO("lifted " << lifted << " J, pushed " << pushed << " J, gained " << gained << " J");
    CHECK(lifted > 0.01);
    CHECK(pushed != 0);
    CHECK(gained == Approx(lifted + pushed).epsilon(0.001));
}
