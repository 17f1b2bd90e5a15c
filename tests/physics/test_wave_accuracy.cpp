// How exact the waves are: their speed, what a basin keeps, what an open border sends back.
#include <cmath>

#include "core/water/field.h"
#include "tests/support/catch.h"
#include "tests/support/worlds.h"

using namespace frm;

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr float g = 9.80665f;

FieldDef def_of(std::int32_t nx, std::int32_t ny, Border border, std::int32_t layer, std::int32_t order) {
    FieldDef def;
    def.nx = nx, def.ny = ny, def.cell = 0.05f, def.depth = 0.5f;
    def.border = border, def.border_cells = layer, def.order = order;
    return def;
}

double wave_speed(const FieldDef& def) { return std::sqrt(static_cast<double>(g * def.depth)); }

/// Speed of a standing wave of 16 cells against sqrt(g d), less one.
double phase_error(std::int32_t order, double courant) {
    const std::int32_t n = 64;
    const FieldDef def = def_of(n, 8, Border::reflecting, 0, order);
    Field field(def, test::memory());
    std::vector<float> h;
    for (std::int32_t j = 0; j < 8; ++j)
        for (std::int32_t i = 0; i < n; ++i) h.push_back(static_cast<float>(0.01 * std::cos(2 * pi * (i + 0.5) / 16)));
    field.set_heights(h.data());
    const double cell = static_cast<double>(def.cell), dt = courant * cell / wave_speed(def);
    // Between zero crossings far apart, each by the line through the heights before and after.
    std::vector<double> crossings;
    float before = field.height_row(0)[0];
    const double period = 16 * cell / wave_speed(def);
    for (int t = 1; t * dt < 60 * period; ++t) {
        field.step(static_cast<float>(dt), g, 1);
        const float now = field.height_row(0)[0];
        if ((before > 0) != (now > 0)) crossings.push_back(t - 1 + static_cast<double>(before / (before - now)));
        before = now;
    }
    const double measured = 2 * (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1) *
                            static_cast<double>(static_cast<float>(dt));
    return period / measured - 1;
}

/// A basin and the energy that leapfrog steps keep exactly but for rounding: g h(n)^2 + d u(n - 1/2) u(n + 1/2).
struct Basin {
    explicit Basin(std::int32_t order) : field(def_of(40, 33, Border::reflecting, 0, order), test::memory()) {
        const double x = 12, y = 20, width = 4;
        std::vector<float> h;
        for (std::int32_t j = 0; j < 33; ++j)
            for (std::int32_t i = 0; i < 40; ++i)
                h.push_back(static_cast<float>(
                    0.05 * std::exp(-((i - x) * (i - x) + (j - y) * (j - y)) / (2 * width * width))));
        field.set_heights(h.data());
        dt = Field::stable_step(field.def(), g);
    }

    double energy_over_a_step() {
        std::vector<double> u;
        each_velocity([&](float v) { u.push_back(static_cast<double>(v)); });
        double potential = 0, kinetic = 0;
        for (std::int32_t j = 0; j < 33; ++j)
            for (std::int32_t i = 0; i < 40; ++i)
                potential += static_cast<double>(field.height_row(j)[i]) * static_cast<double>(field.height_row(j)[i]);
        field.step(dt, g, 1);
        std::size_t k = 0;
        each_velocity([&](float v) { kinetic += static_cast<double>(v) * u[k++]; });
        return static_cast<double>(g) * potential + static_cast<double>(field.def().depth) * kinetic;
    }

    template <typename Use>
    void each_velocity(const Use& use) const {
        for (std::int32_t j = 0; j < 33; ++j)
            for (std::int32_t i = 0; i <= 40; ++i) use(field.velocity_x_row(j)[i]);
        for (std::int32_t j = 0; j <= 33; ++j)
            for (std::int32_t i = 0; i < 40; ++i) use(field.velocity_y_row(j)[i]);
    }

    double volume() const {
        double sum = 0;
        for (std::int32_t j = 0; j < 33; ++j)
            for (std::int32_t i = 0; i < 40; ++i) sum += static_cast<double>(field.height_row(j)[i]);
        return sum;
    }

    Field field;
    float dt;
};

/// The largest energy of what the border sent back into the water inside of the layer, against what went out: the
/// difference from water so large that its borders are not met.
double returned(std::int32_t order, std::int32_t layer, double x, double y, double width) {
    const std::int32_t n = 128, large = 512, shift = (large - n) / 2;
    FieldDef def = def_of(n, n, Border::absorbing, layer, order);
    Field open(def, test::memory());
    Field sea(def_of(large, large, Border::reflecting, 0, order), test::memory());
    const auto hill = [&](std::int32_t size, double cx, double cy) {
        std::vector<float> h;
        for (std::int32_t j = 0; j < size; ++j)
            for (std::int32_t i = 0; i < size; ++i)
                h.push_back(static_cast<float>(
                    0.05 * std::exp(-((i - cx) * (i - cx) + (j - cy) * (j - cy)) / (2 * width * width))));
        return h;
    };
    open.set_heights(hill(n, x, y).data());
    sea.set_heights(hill(large, x + shift, y + shift).data());
    const auto energy = [&](bool of_difference) {
        double h = 0, u = 0;
        const auto square = [](double v) { return v * v; };
        for (std::int32_t j = 16; j < n - 16; ++j)
            for (std::int32_t i = 16; i < n - 16; ++i) {
                const auto value = [&](const float* a, const float* b) {
                    return square(static_cast<double>(of_difference ? a[i] - b[i + shift] : a[i]));
                };
                h += value(open.height_row(j), sea.height_row(j + shift));
                u += value(open.velocity_x_row(j), sea.velocity_x_row(j + shift));
                u += value(open.velocity_y_row(j), sea.velocity_y_row(j + shift));
            }
        return static_cast<double>(g) * h + static_cast<double>(def.depth) * u;
    };
    const double out = energy(false);
    const double dt = 0.3 * static_cast<double>(def.cell) / wave_speed(def);
    double most = 0;
    // 300 cells: out, and back across the water; the sea's own border answers after 384.
    for (int t = 0; t < 1000; ++t) {
        open.step(static_cast<float>(dt), g, 1);
        sea.step(static_cast<float>(dt), g, 1);
        if (t % 20 == 0) most = std::fmax(most, energy(true));
    }
    return most / out;
}

}  // namespace

TEST_CASE("waves of 16 cells run at the right speed, to 0.65 % at second order and 0.1 % at fourth", "[accuracy]") {
    for (const double courant : {0.05, 0.18, 0.3, 0.4}) {
        const double second = phase_error(2, courant), fourth = phase_error(4, courant);
        UNSCOPED_INFO("Courant " << courant << ": " << 100 * second << " %, " << 100 * fourth << " %");
        CHECK(std::fabs(second) < 0.0065);
        CHECK(std::fabs(fourth) < 0.001);
    }
    CHECK(phase_error(2, 0.05) < -0.006);
    // The longest step that stable_step allows.
    CHECK(std::fabs(phase_error(2, 0.63)) < 0.0065);
    CHECK(phase_error(4, 0.6) > 0.002);
}

TEST_CASE("a closed basin keeps its energy and its volume over ten thousand periods", "[accuracy]") {
    for (const std::int32_t order : {2, 4}) {
        Basin basin(order);
        const double energy = basin.energy_over_a_step(), volume = basin.volume();
        const double period = 2 * 40 * 0.05 / wave_speed(basin.field.def());
        const auto steps = static_cast<std::int64_t>(10000 * period / static_cast<double>(basin.dt));
        double worst_energy = 0, worst_volume = 0;
        for (std::int64_t t = 0; t < steps; t += 1000) {
            basin.field.advance(basin.dt, g, 999, nullptr, 0, 1);
            worst_energy = std::fmax(worst_energy, std::fabs(basin.energy_over_a_step() / energy - 1));
            worst_volume = std::fmax(worst_volume, std::fabs(basin.volume() - volume));
        }
        const double water = 40 * 33 * 0.5;
        UNSCOPED_INFO("order " << order << ", " << steps << " steps: energy " << worst_energy << ", volume "
                               << worst_volume / water << " of the water, " << worst_volume / volume << " of the wave");
        CHECK(worst_energy < 1e-4);
        CHECK(worst_volume < 1e-6 * water);
    }
}

TEST_CASE("an open border sends back less than a hundredth of a pulse's energy", "[accuracy]") {
    for (const std::int32_t order : {2, 4})
        for (const std::int32_t layer : {0, 16}) {
            // In the middle; near a border, so that most of it meets that at an angle; in a corner; and long pulses,
            // the longest of them as wide as the water.
            const double middle = returned(order, layer, 64, 64, 4), oblique = returned(order, layer, 64, 26, 4),
                         corner = returned(order, layer, 28, 24, 4), longer = returned(order, layer, 64, 64, 12),
                         longer_oblique = returned(order, layer, 64, 36, 12),
                         longest = returned(order, layer, 64, 64, 24);
            UNSCOPED_INFO("order " << order << ", layer " << layer << ": " << middle << ", " << oblique << ", "
                                   << corner << "; longer " << longer << ", " << longer_oblique << ", " << longest);
            CHECK(middle < 0.005);
            CHECK(oblique < 0.005);
            CHECK(corner < 0.01);
            CHECK(longer < 0.01);
            CHECK(longer_oblique < 0.01);
            CHECK(longest < 0.02);
        }
}
