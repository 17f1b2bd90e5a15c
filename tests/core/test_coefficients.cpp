// Added mass and damping as the interface gives them (frm_body_get_coefficients).
#include <cmath>

#include "core/api/axes.h"
#include "core/body/coefficients.h"
#include "tests/support/library.h"

using namespace frm;
using namespace frm::test;

namespace {

using Matrix = std::array<double, 36>;

double form(const Matrix& m, const double (&x)[6], const double (&y)[6]) {
    double sum = 0;
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) sum += x[i] * m[6 * i + j] * y[j];
    return sum;
}

/// A plate across x, in the deep. Its drag along x is that of its two faces.
Coefficients of_plate(const Twist& twist, const Quat<float>& rotation, float scale = 1, double* drag = nullptr) {
    Map map = bake::formula_map(fine_box({0.004, 0.3, 0.3}, 0.1), 6, 1, 4);
    map.has_added_mass = true;
    for (std::size_t i = 0; i < 6; ++i) map.added_mass[7 * i] = 1.0 + static_cast<double>(i);
    map.complete();
    WorldDef def;
    World world = world_of(def);
    BodyDef body = body_of(std::make_shared<Map>(std::move(map)), {0, 0, -50}, rotation, twist);
    body.scale = scale;
    Body& made = world.create_body(body);
    world.tick(1e-5f);
    if (drag) *drag = -static_cast<double>(made.forces.pressure.force.x);
    return coefficients_of(made, def.fluid);
}

}  // namespace

TEST_CASE("a plate's damping is the slope of its drag", "[coefficients]") {
    // Pressure goes with u^2, so it grows by twice itself over u. Front and lee have rho / 2 u^2 A and half of that
    // (bake/map/formula.h), less what the regions that go around an edge lack.
    double drag = 0, large_drag = 0;
    const double u = 2;
    const Coefficients c = of_plate({{2, 0, 0}, {}}, {}, 1, &drag);
    CHECK(drag == Approx(1.5 * 500 * 0.09 * u * u).epsilon(0.1));
    const double slope = 2 * drag / u;
    CHECK(c.wet_share == Approx(1).epsilon(1e-5));
    CHECK(c.damping[0] == Approx(slope).epsilon(0.03));
    // The thin sides are all that is rubbed or pushed across.
    CHECK(c.damping[7] < 0.05 * slope);
    // The faces lie at x = +-2 mm and are centred, but their sources are not: torque about y is as their arms ask for.
    CHECK(c.damping[28] >= 0);
    CHECK(of_plate({}, {}).damping[0] < 0.01 * slope);
    CHECK(of_plate({{2, 0, 0}, {}}, {}, 3, &large_drag).damping[0] == Approx(9 * slope).epsilon(0.03));
    CHECK(large_drag == Approx(9 * drag).epsilon(0.01));
}

TEST_CASE("added mass goes with the wet share and turns with the body", "[coefficients]") {
    const Coefficients c = of_plate({}, {}), turned_c = of_plate({}, turned({0, 0, 1}, 1.5707963267948966)),
                       large = of_plate({}, {}, 2);
    for (std::size_t i = 0; i < 6; ++i)
        CHECK(c.added_mass[7 * i] == Approx(1.0 + static_cast<double>(i)).epsilon(1e-5));
    CHECK(turned_c.added_mass[0] == Approx(2).epsilon(1e-4));
    CHECK(turned_c.added_mass[7] == Approx(1).epsilon(1e-4));
    CHECK(turned_c.added_mass[21] == Approx(5).epsilon(1e-4));
    CHECK(large.added_mass[0] == Approx(8).epsilon(1e-5));
    CHECK(large.added_mass[35] == Approx(6 * 32).epsilon(1e-5));
}

TEST_CASE("the matrices are those of the same body in every host's axes", "[coefficients]") {
    // What does not depend on axes: twist . matrix . twist, of the body's own twist.
    static const auto file = encode_map(full_map(fine_box({0.2, 0.1, 0.3}, 0.1)));
    double damping[4], added[4];
    for (std::uint32_t axes = 0; axes < 4; ++axes) {
        frm_context context = 0;
        frm_context_def def{};
        REQUIRE(frm_context_def_init(&def, sizeof def) == FRM_OK);
        def.axes = axes;
        REQUIRE(frm_context_create(&def, &context) == FRM_OK);
        frm_map map = 0;
        REQUIRE(frm_map_open_memory(context, file.data(), file.size(), &map) == FRM_OK);
        frm_world world = 0;
        REQUIRE(frm_world_create(context, nullptr, &world) == FRM_OK);
        frm_body_def body_def{};
        REQUIRE(frm_body_def_init(&body_def, sizeof body_def) == FRM_OK);
        body_def.map = map;
        const api::Axes host(axes);
        body_def.pose = host.pose_out({{0, 0, -0.02}, turned({1, 2, 3}, 0.7)});
        body_def.twist = host.twist_out({{0.4f, -0.3f, 0.2f}, {0.5f, 1, -2}});
        frm_body body = 0;
        REQUIRE(frm_body_create(world, &body_def, &body) == FRM_OK);
        REQUIRE(frm_world_tick(world, 0.002f) == FRM_OK);
        frm_coefficients c{};
        c.struct_size = sizeof c;
        REQUIRE(frm_body_get_coefficients(body, &c) == FRM_OK);
        CHECK((c.wet_share > 0.3f && c.wet_share < 0.8f));
        const frm_twist& t = body_def.twist;
        const double x[6] = {static_cast<double>(t.linear.x),  static_cast<double>(t.linear.y),
                             static_cast<double>(t.linear.z),  static_cast<double>(t.angular.x),
                             static_cast<double>(t.angular.y), static_cast<double>(t.angular.z)};
        Matrix d, a;
        std::copy(c.damping, c.damping + 36, d.begin());
        std::copy(c.added_mass, c.added_mass + 36, a.begin());
        damping[axes] = form(d, x, x), added[axes] = form(a, x, x);
        frm_context_destroy(context);
    }
    CHECK(damping[0] > 1);
    for (int k = 1; k < 4; ++k) {
        CHECK(damping[k] == Approx(damping[0]).epsilon(1e-4));
        CHECK(added[k] == Approx(added[0]).epsilon(1e-4));
    }
}
