// Added mass against formulas: Lamb, Hydrodynamics, 6th ed. (1932), articles 71, 92, 114, 115 and 138. Numbers of
// DNV-RP-C205 (2010), appendix D, where there is no formula. 2 % is what the map promises;
// 1 % where the answer is exact.
#include <array>
#include <cmath>
#include <cstddef>
#include <string>

#include "bake/error.h"
#include "bake/potential/added_mass.h"
#include "bake/potential/coarsen.h"
#include "bake/potential/elementary.h"
#include "bake/potential/refine.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;
using namespace frm::test;

namespace {

const double pi = 3.14159265358979323846;

AddedMass quick(const Surface& surface, std::size_t triangles = 1600, int threads = 0) {
    AddedMassSettings settings;
    settings.density = 1;
    settings.most_triangles = triangles;
    settings.threads = threads;
    return added_mass(surface, settings);
}

double at(const AddedMass& mass, std::size_t i, std::size_t j) { return mass.matrix[6 * i + j]; }

Surface spheroid(double ratio, int subdivisions = 4) {
    Surface s = icosphere(1, subdivisions);
    for (Vec3d& v : s.vertices) v.z *= ratio;
    return s;
}

// Lamb's coefficients of an oblate spheroid of half axes 1, 1, c: over rho V, and over rho V for the turning about x.
struct Oblate {
    double axial, edgewise, turning;
    explicit Oblate(double c) {
        const double e = std::sqrt(1 - c * c), gamma = 2 / (e * e) * (1 - c / e * std::asin(e)), beta = 1 - gamma / 2;
        axial = gamma / (2 - gamma);
        edgewise = beta / (2 - beta);
        const double d = 1 - c * c;
        turning = d * d * (gamma - beta) / (2 * d + (1 + c * c) * (beta - gamma)) / 5;
    }
};

void require_symmetric_and_positive(const AddedMass& mass) {
    std::array<double, 36> rest = mass.matrix;
    for (std::size_t k = 0; k < 6; ++k) {
        REQUIRE(rest[7 * k] > 0);  // a pivot
        for (std::size_t i = 0; i < 6; ++i) REQUIRE(at(mass, i, k) == at(mass, k, i));
        for (std::size_t i = k + 1; i < 6; ++i)
            for (std::size_t j = k + 1; j < 6; ++j) rest[6 * i + j] -= rest[6 * i + k] * rest[6 * k + j] / rest[7 * k];
    }
}

}  // namespace

TEST_CASE("elementary functions of the panels agree with the library's") {
    for (double x = 1e-9; x < 1; x += 0.00137) REQUIRE(area_tangent(x) == Approx(std::atanh(x)).epsilon(1e-13));
    REQUIRE(area_tangent(1 - 1e-14) == Approx(std::atanh(1 - 1e-14)).epsilon(1e-13));
    for (double a = -3.14; a < 3.14; a += 0.0173)
        REQUIRE(angle_of(std::sin(a), std::cos(a)) == Approx(a).epsilon(1e-13).margin(1e-15));
}

TEST_CASE("added mass of a sphere is half of what it displaces, and nothing when it turns") {
    const Surface sphere = icosphere(0.7, 3);
    const double volume = measure(sphere).volume;
    const AddedMass mass = quick(sphere);
    require_symmetric_and_positive(mass);
    for (std::size_t i = 0; i < 3; ++i) {
        REQUIRE(at(mass, i, i) == Approx(0.5 * volume).epsilon(0.003));
        REQUIRE(at(mass, i + 3, i + 3) < 2e-3 * at(mass, i, i) * 0.49);
        for (std::size_t j = 0; j < 6; ++j) {
            if (j != i) REQUIRE(std::abs(at(mass, i, j)) < 1e-3 * volume);
        }
    }
    REQUIRE(mass.error < 0.02);
}

TEST_CASE("added mass of spheroids is Lamb's, down to a disk") {
    for (const double c : {0.01, 0.2, 0.5, 0.8}) {
        const Surface s = spheroid(c);
        const double volume = measure(s).volume;
        const Oblate exact(c);
        const AddedMass mass = quick(s, c < 0.1 ? 3200 : 1600);
        require_symmetric_and_positive(mass);
        INFO("half axis " << c << ", estimated error " << mass.error);
        REQUIRE(at(mass, 2, 2) == Approx(exact.axial * volume).epsilon(0.01));
        REQUIRE(at(mass, 3, 3) == Approx(exact.turning * volume).epsilon(0.01));
        REQUIRE(at(mass, 4, 4) == Approx(at(mass, 3, 3)).epsilon(0.005));
        if (c >= 0.2) REQUIRE(at(mass, 0, 0) == Approx(exact.edgewise * volume).epsilon(0.01));
        if (c < 0.1) {  // the disk: 8/3 rho a^3 and 16/45 rho a^5
            REQUIRE(at(mass, 2, 2) == Approx(8.0 / 3).epsilon(0.02));
            REQUIRE(at(mass, 3, 3) == Approx(16.0 / 45).epsilon(0.02));
        }
        REQUIRE(mass.error < 0.02);
    }
}

TEST_CASE("added mass in the middle of long bodies is that of their sections") {
    const auto of_section = [](const Surface& longer, const Surface& shorter, double length) {
        return (at(quick(longer), 0, 0) - at(quick(shorter), 0, 0)) / length;
    };
    // A circle: rho A. The polygon's own area is what it displaces.
    const Surface longer = cylinder(1, 20, 32), shorter = cylinder(1, 12, 32);
    const double area = (measure(longer).volume - measure(shorter).volume) / 8;
    REQUIRE(of_section(longer, shorter, 8) == Approx(area).epsilon(0.02));
    // DNV-RP-C205 table D-1: a square 1.51 rho pi a^2, a half the width.
    REQUIRE(of_section(box({2, 2, 20}), box({2, 2, 12}), 8) == Approx(1.51 * pi).epsilon(0.02));
}

TEST_CASE("added mass of thin rectangular plates is that of DNV-RP-C205, table D-2") {
    // Theirs have no thickness. 1/500 of the width adds 1 % to the square plate's; halving takes it out.
    for (const auto& [ratio, coefficient] : {std::pair{1.0, 0.579}, {5.0, 0.897}}) {
        const AddedMass thick = quick(box({1, ratio, 0.004})), thin = quick(box({1, ratio, 0.002}));
        require_symmetric_and_positive(thin);
        const double none = 2 * at(thin, 2, 2) - at(thick, 2, 2);
        INFO("plate 1 x " << ratio);
        REQUIRE(none == Approx(coefficient * pi / 4 * ratio).epsilon(0.02));
    }
}

TEST_CASE("added mass of a cube lies between two methods' numbers") {
    // DNV-RP-C205, table D-2, has 0.68, which the converged number is not: docs/added-mass.md. Constant sources on 216
    // to 2,400 rectangles, graded towards the edges, their equation met at the middles (Hess & Smith), give 0.6573,
    // 0.6489, 0.6432, 0.6411 and 0.6401 from above; the form used here rises from below.
    const AddedMass cube = quick(box({1, 1, 1}), 3200);
    require_symmetric_and_positive(cube);
    for (std::size_t i = 0; i < 3; ++i) {
        REQUIRE(at(cube, i, i) > 0.636);
        REQUIRE(at(cube, i, i) < 0.641);
    }
    REQUIRE(cube.error < 0.03);  // a cube that turns is the hardest: the water is pushed near the edges only
}

TEST_CASE("added mass of two spheres that move in line is Lamb's") {
    // Article 138, to the sixth power of radius over distance.
    const double q = 1.0 / 27;
    const Surface sphere = icosphere(1, 2);
    const AddedMass mass = quick(joined(sphere, moved(sphere, {0, 3, 0})));
    require_symmetric_and_positive(mass);
    REQUIRE(at(mass, 1, 1) == Approx(measure(sphere).volume * (1 - 3 * q + 3 * q * q)).epsilon(0.01));
    REQUIRE(mass.buried == 0);
}

TEST_CASE("added mass turns, moves and grows with its body") {
    const Surface plate = box({0.5, 1, 0.02});
    const Vec3d axis(1, 2, -0.5), by(3, -1, 2);
    const AddedMass own = quick(plate), other = quick(moved(rotated(plate, axis, 0.7), by));
    require_symmetric_and_positive(other);
    // The same motion of the body in both frames: the same energy.
    for (std::size_t k = 0; k < 6; ++k) {
        Vec3d u, w;
        (k < 3 ? u : w)[static_cast<int>(k % 3)] = 1;
        const Vec3d turning = rotated(w, axis, 0.7), velocity = rotated(u, axis, 0.7) - cross(turning, by);
        const double twist[6] = {velocity.x, velocity.y, velocity.z, turning.x, turning.y, turning.z};
        double energy = 0;
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t j = 0; j < 6; ++j) energy += twist[i] * at(other, i, j) * twist[j];
        INFO("motion " << k);
        REQUIRE(energy == Approx(at(own, k, k)).epsilon(0.02));
    }
    Surface large = plate;
    for (Vec3d& v : large.vertices) v = v * 10.0;
    AddedMassSettings settings;
    settings.density = 1025;
    settings.most_triangles = 1600;
    const AddedMass heavy = added_mass(large, settings);
    // Rounding decides which of two mirrored triangles is halved first, and so which ones are left.
    REQUIRE(at(heavy, 2, 2) == Approx(1025e3 * at(own, 2, 2)).epsilon(0.003));
    REQUIRE(at(heavy, 3, 3) == Approx(1025e5 * at(own, 3, 3)).epsilon(0.003));
}

TEST_CASE("added mass is the same bits with any number of threads") {
    const Surface plate = box({0.5, 1, 0.02});
    const AddedMass one = quick(plate, 600, 1);
    for (const int threads : {2, 3, 5}) REQUIRE(quick(plate, 600, threads).matrix == one.matrix);
}

TEST_CASE("added mass of a mesh made for the eye is that of its shape") {
    const Surface fine = spheroid(0.5, 6);  // 81,920 triangles
    const Coarse coarse = coarsen(fine, 1000);
    REQUIRE(coarse.changed);
    REQUIRE(coarse.surface.triangles.size() <= 1000);
    REQUIRE(measure(coarse.surface).volume == Approx(measure(fine).volume).epsilon(1e-6));
    const AddedMass mass = quick(fine);
    REQUIRE(at(mass, 2, 2) == Approx(Oblate(0.5).axial * measure(fine).volume).epsilon(0.01));
    REQUIRE(mass.error < 0.03);

    // A triangle without height, as where a side of one is two sides of others.
    const AddedMass cube = quick(box({1, 1, 1}));
    Surface flat = box({1, 1, 1});
    flat.vertices.push_back((flat.vertices[0] + flat.vertices[4]) * 0.5);
    flat.triangles[0] = {0, 8, 6};
    flat.triangles.push_back({8, 4, 6});
    flat.triangles.push_back({0, 4, 8});
    const AddedMass same = quick(flat);
    for (std::size_t i = 0; i < 6; ++i) REQUIRE(at(same, i, i) == Approx(at(cube, i, i)).epsilon(0.01));
}

TEST_CASE("added mass of pieces that run into each other is nearly that of their union") {
    // A prism of two boxes, of which one is a thousandth slimmer so that no faces coincide.
    const AddedMass whole = quick(box({1, 1, 2}));
    REQUIRE(whole.buried == 0);
    const Surface low = moved(box({1, 1, 1.2}), {0, 0, -0.4}), high = moved(box({0.999, 0.999, 1.2}), {0, 0, 0.4});
    const AddedMass pieces = quick(joined(low, high));
    require_symmetric_and_positive(pieces);
    // Both have an end in the other, the slim one a third of its sides too: 1 + 1 + 1.6 of 13.6.
    REQUIRE(pieces.buried == Approx(3.6 / 13.6).margin(0.02));
    for (std::size_t k = 0; k < 3; ++k) REQUIRE(at(pieces, k, k) == Approx(at(whole, k, k)).epsilon(0.06));
}

TEST_CASE("added mass names what it cannot take") {
    AddedMassSettings settings;
    settings.density = 0;
    REQUIRE_THROWS_AS(added_mass(box({1, 1, 1}), settings), BakeError);
    settings.density = 1000;
    settings.most_triangles = 100;
    REQUIRE_THROWS_AS(added_mass(box({1, 1, 1}), settings), BakeError);
    settings.most_triangles = 400;
    Surface many;
    for (int i = 0; i < 100; ++i) many = joined(many, moved(box({1, 1, 1}), {2.0 * i, 0, 0}));
    REQUIRE_THROWS_WITH(added_mass(many, settings), Catch::Contains("too many pieces"));
}

TEST_CASE("refining halves where the error is and keeps the shape") {
    const Surface cube = box({1, 1, 1});
    std::vector<double> error(cube.triangles.size(), 0.0);
    error[5] = 1;
    const Surface finer = refine(cube, error, 100);
    REQUIRE(finer.triangles.size() > 90);
    REQUIRE(finer.triangles.size() <= 100);
    REQUIRE(measure(finer).volume == Approx(1).epsilon(1e-12));
    REQUIRE(measure(finer).area == Approx(6).epsilon(1e-12));
    REQUIRE_THROWS_AS(refine(cube, {1, 2}, 100), BakeError);
}
