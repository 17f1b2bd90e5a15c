// The symmetry of a body is found wherever it lies, and a direction goes to the same place as all that it is carried
// into.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bake/mesh/tree.h"
#include "bake/regions/tessellate.h"
#include "bake/symmetry/symmetry.h"
#include "tests/support/catch.h"
#include "tests/support/processor_time.h"
#include "tests/support/samples.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;

namespace {

Surface tetrahedron() {
    Surface s;
    s.vertices = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    s.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
    return s;
}

Surface cone(int segments) {
    Surface s = test::cylinder(0.5, 1, segments);
    for (Vec3d& v : s.vertices)
        if (v.z > 0) v = {v.x * 0.3, v.y * 0.3, v.z};
    return s;
}

// A box of 1 x 0.8 x 0.6 with a pyramid of the given depth pressed into the side x = 0.5, all symmetry but its two
// mirror planes' gone.
Surface dented(double depth) {
    Surface s = tessellate(test::box({1, 0.8, 0.6}), 0.15, 100000).surface;
    for (Vec3d& v : s.vertices) {
        if (v.x < 0.4999) continue;
        const double near = std::max(std::fabs(v.y) / 0.3, std::fabs(v.z) / 0.25);
        v.x -= depth * std::max(0.0, 1 - near);
    }
    return s;
}

// No rotation or reflection does anything for it.
Surface lopsided() {
    Surface s = test::joined(test::box({1, 0.6, 0.2}), test::moved(test::box({0.2, 0.3, 0.5}), {0.3, 0.1, 0.4}));
    return test::joined(s, test::moved(test::box({0.1, 0.2, 0.3}), {-0.3, -0.4, -0.2}));
}

Surface thrown(const Surface& s) { return test::moved(test::rotated(s, {1, -2, 0.7}, 2.1), {12, -3, 0.4}); }

// Flat pitched blades (each the same after half a turn about its own length), or ones bent aft as well.
Surface propeller(int blades, double bend) {
    Surface blade = test::moved(test::rotated(test::box({0.8, 0.2, 0.03}), {1, 0, 0}, 0.5), {0.6, 0, 0});
    for (Vec3d& v : blade.vertices) v.z += bend * v.x * v.x;
    Surface s = blade;
    for (int i = 1; i < blades; ++i)
        s = test::joined(s, test::rotated(blade, {0, 0, 1}, 2 * 3.14159265358979323846 * i / blades));
    return s;
}

double off(const Matrix3& a, const Matrix3& b) {
    double largest = 0;
    for (std::size_t i = 0; i < 3; ++i) largest = std::max(largest, length(a.row[i] - b.row[i]));
    return largest;
}

std::size_t nearest(const std::vector<Matrix3>& elements, const Matrix3& g) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < elements.size(); ++i)
        if (off(elements[i], g) < off(elements[best], g)) best = i;
    return best;
}

void check_group(const Surface& surface, const Symmetry& symmetry) {
    REQUIRE(!symmetry.elements.empty());
    CHECK(off(symmetry.elements.front(), Matrix3{}) == 0);
    CHECK(symmetry.worst <= symmetry.tolerance);
    double skew = 0, open = 0;
    for (const Matrix3& a : symmetry.elements) {
        skew = std::max(skew, off(a * transpose(a), Matrix3{}));
        for (const Matrix3& b : symmetry.elements)
            open = std::max(open, off(symmetry.elements[nearest(symmetry.elements, a * b)], a * b));
    }
    CHECK(skew < 1e-12);
    CHECK(open < 1e-12);
    const Tree tree(surface.vertices, surface.triangles);
    double worst = 0;
    for (const Matrix3& g : symmetry.elements)
        for (const Vec3d& v : surface.vertices)
            worst = std::max(worst, tree.squared_distance(symmetry.centre + g * (v - symmetry.centre), 1e9));
    // Every vertex, where the search itself may have sampled them.
    CHECK(std::sqrt(worst) <= 1.2 * symmetry.tolerance);
}

std::vector<Vec3d> directions(std::size_t count) {
    std::vector<Vec3d> result;
    for (std::size_t i = 0; i < count; ++i) {
        const double z = 1 - (2.0 * static_cast<double>(i) + 1) / static_cast<double>(count);
        const double r = std::sqrt(1 - z * z), angle = 2.399963 * static_cast<double>(i);
        result.push_back({r * std::cos(angle), r * std::sin(angle), z});
    }
    // And those that lie on borders of domains.
    for (int i = -1; i <= 1; ++i)
        for (int j = -1; j <= 1; ++j)
            for (int k = -1; k <= 1; ++k)
                if (i != 0 || j != 0 || k != 0)
                    result.push_back(Vec3d(i, j, k) / std::sqrt(double(i * i + j * j + k * k)));
    return result;
}

void check_canonical(const Symmetry& symmetry, const std::vector<Matrix3>& carriers) {
    double lost = 0, skew = 0, moved = 0, turned = 0, apart = 0;
    for (const Vec3d& d : directions(40)) {
        const Canonical c = canonical(symmetry, d);
        lost = std::max(lost, length(c.element * c.direction - d));
        skew = std::max(skew, off(c.element * transpose(c.element), Matrix3{}));
        const Canonical again = canonical(symmetry, c.direction);
        moved = std::max(moved, length(again.direction - c.direction));
        turned = std::max(turned, off(again.element, Matrix3{}));
        for (const Matrix3& g : carriers)
            apart = std::max(apart, length(canonical(symmetry, g * d).direction - c.direction));
    }
    CHECK(lost < 1e-9);
    CHECK(skew < 1e-12);
    CHECK(moved < 1e-9);
    CHECK(turned < 1e-7);
    CHECK(apart < 1e-8);
}

void check_finite(const Surface& surface, std::size_t elements) {
    for (const Surface& s : {surface, thrown(surface)}) {
        const Symmetry symmetry = find_symmetry(s);
        CHECK(symmetry.kind == SymmetryKind::finite);
        CHECK(symmetry.elements.size() == elements);
        check_group(s, symmetry);
        check_canonical(symmetry, symmetry.elements);
    }
}

void check_round(const Surface& surface, SymmetryKind kind, const Vec3d& axis) {
    const Symmetry symmetry = find_symmetry(surface);
    CHECK(symmetry.kind == kind);
    CHECK(symmetry.worst <= symmetry.tolerance);
    std::vector<Matrix3> carriers;
    for (const double angle : {0.3, 2.0, 5.0}) carriers.push_back(rotation_about(symmetry.axis, angle));
    carriers.push_back(mirror_across(any_across(symmetry.axis)));
    if (kind != SymmetryKind::axial) carriers.push_back(mirror_across(symmetry.axis));
    if (kind == SymmetryKind::spherical)
        carriers.push_back(rotation_about({1, 0, 0}, 1));
    else
        CHECK(std::fabs(dot(symmetry.axis, axis)) > 1 - 1e-6);
    check_canonical(symmetry, carriers);
}

}  // namespace

TEST_CASE("the nearest point of a surface is found by the tree as by looking at all", "[symmetry]") {
    const Surface s = lopsided();
    const Tree tree(s.vertices, s.triangles);
    for (const Vec3d& d : directions(200)) {
        const Vec3d p = d * (0.2 + 0.6 * std::fabs(d.x));
        // Against a dense net of points on each triangle: never nearer than they are, nor much farther.
        double least = 1e9;
        for (std::size_t t = 0; t < s.triangles.size(); ++t)
            for (int i = 0; i <= 40; ++i)
                for (int j = 0; i + j <= 40; ++j) {
                    const Vec3d at =
                        (s.corner(t, 0) * (1.0 * i) + s.corner(t, 1) * (1.0 * j) + s.corner(t, 2) * (40.0 - i - j)) /
                        40.0;
                    least = std::min(least, length(at - p));
                }
        const double found = std::sqrt(tree.squared_distance(p, 1e9));
        CHECK(found <= least + 1e-12);
        CHECK(found >= least - 0.02);
        CHECK(tree.squared_distance(p, 0.25 * found * found) == 0.25 * found * found);
    }
}

TEST_CASE("finite symmetries have all their elements, wherever the body lies", "[symmetry]") {
    SECTION("box") { check_finite(test::box({0.4, 0.3, 0.2}), 8); }
    SECTION("plate") { check_finite(test::box({1, 0.6, 0.01}), 8); }
    SECTION("cube") { check_finite(test::box({1, 1, 1}), 48); }
    SECTION("cube of many triangles") { check_finite(tessellate(test::box({1, 1, 1}), 0.1, 100000).surface, 48); }
    SECTION("square prism") { check_finite(test::box({1, 1, 2}), 16); }
    // Of a share of its length its corners would be nothing.
    SECTION("square rod") { check_finite(test::box({1, 1, 100}), 16); }
    SECTION("three sides") { check_finite(test::cylinder(0.5, 1, 3), 12); }
    SECTION("five sides") { check_finite(test::cylinder(0.5, 1, 5), 20); }
    SECTION("eight sides") { check_finite(test::cylinder(0.5, 1, 8), 32); }
    SECTION("a pyramid") { check_finite(cone(4), 8); }
    SECTION("tetrahedron") { check_finite(tetrahedron(), 24); }
    SECTION("icosahedron") { check_finite(test::icosphere(1, 0), 120); }
    SECTION("three blades: rotations without reflections") { check_finite(propeller(3, 0), 6); }
    SECTION("four bent blades") { check_finite(propeller(4, 0.3), 4); }
    SECTION("none") { check_finite(lopsided(), 1); }
    SECTION("two bodies side by side") {
        check_finite(test::joined(test::moved(test::box({0.4, 0.3, 0.2}), {1, 0, 0}), test::box({0.4, 0.3, 0.2})), 8);
    }
    SECTION("two bodies askew") {
        // A half turn about each axis is lost but that across the plane of the shift; with it the inversion.
        check_finite(test::joined(test::moved(test::box({0.4, 0.3, 0.2}), {1, 0.5, 0}), test::box({0.4, 0.3, 0.2})), 4);
    }
    SECTION("paddle") { check_finite(test::sample("paddle.glb"), 4); }
    SECTION("canoe") { check_finite(test::sample("canoe.glb"), 4); }
    SECTION("sample plate") { check_finite(test::sample("plate.glb"), 8); }
}

TEST_CASE("round bodies are known although they are made of flat facets", "[symmetry]") {
    const Vec3d z{0, 0, 1};
    for (const int subdivisions : {2, 3, 5})
        check_round(test::icosphere(0.3, subdivisions), SymmetryKind::spherical, z);
    for (const int sides : {16, 24, 37}) {
        check_round(test::cylinder(0.5, 3, sides), SymmetryKind::axial_mirrored, z);
        check_round(test::cylinder(0.5, 0.02, sides), SymmetryKind::axial_mirrored, z);
    }
    // As long as it takes for the moments about all axes to be equal.
    check_round(test::cylinder(0.5, 0.866, 24), SymmetryKind::axial_mirrored, z);
    check_round(cone(24), SymmetryKind::axial, z);
    check_round(thrown(cone(24)), SymmetryKind::axial, test::rotated(z, {1, -2, 0.7}, 2.1));
    // Facets finer than the chords: vertices in the middle of flat facets are no dents.
    check_round(tessellate(test::cylinder(0.5, 3, 24), 0.1, 100000).surface, SymmetryKind::axial_mirrored, z);
    check_round(tessellate(test::icosphere(1, 2), 0.1, 100000).surface, SymmetryKind::spherical, z);
}

TEST_CASE("the chords' tolerance is not for dents", "[symmetry]") {
    Surface ball = test::icosphere(1, 4);
    for (Vec3d& v : ball.vertices) {
        const double near = length(v - Vec3d{0, 0, 1});
        if (near < 0.4) v = v * (1 - 0.015 * (1 - near / 0.4));  // of 1.5 %: below the tolerance of a chord
    }
    const Symmetry symmetry = find_symmetry(ball);
    CHECK(symmetry.kind == SymmetryKind::axial);
    CHECK(std::fabs(symmetry.axis.z) > 0.999);
}

TEST_CASE("a dent counts from the tolerance on", "[symmetry]") {
    const Symmetry whole = find_symmetry(dented(0));
    CHECK(whole.elements.size() == 8);
    CHECK(whole.tolerance == Approx(0.005 * whole.size));
    // The dent moves the centroid by a tenth of its depth, and so its distance from its image is less than that.
    const auto image_off = [](double depth) { return depth + 2 * measure(dented(depth)).centroid.x; };
    const double share = image_off(0.001) / 0.001;
    const Symmetry under = find_symmetry(dented(0.95 * whole.tolerance / share));
    CHECK(under.elements.size() == 8);
    CHECK(under.worst == Approx(0.95 * whole.tolerance).epsilon(0.02));
    const double deeper = 1.05 * whole.tolerance / share;
    CHECK(find_symmetry(dented(deeper)).elements.size() == 4);
    SymmetryOptions wider;
    wider.tolerance = 0.006;
    CHECK(find_symmetry(dented(deeper), wider).elements.size() == 8);
}

TEST_CASE("elements are in the order that is documented", "[symmetry]") {
    const std::vector<Matrix3> g = find_symmetry(test::box({0.4, 0.3, 0.2})).elements;
    const auto diagonal = [](double x, double y, double z) {
        return Matrix3{{Vec3d{x, 0, 0}, Vec3d{0, y, 0}, Vec3d{0, 0, z}}};
    };
    const std::vector<Matrix3> expected = {diagonal(1, 1, 1),   diagonal(1, -1, -1), diagonal(-1, 1, -1),
                                           diagonal(-1, -1, 1), diagonal(1, 1, -1),  diagonal(1, -1, 1),
                                           diagonal(-1, 1, 1),  diagonal(-1, -1, -1)};
    REQUIRE(g.size() == expected.size());
    for (std::size_t i = 0; i < g.size(); ++i) CHECK(off(g[i], expected[i]) == 0);
}

TEST_CASE("symmetry of large meshes is found in the time of a look", "[symmetry]") {
    // Measured on a quiet core: 0.1 s, 0.7 s and 0.5 s. The bounds only catch what has become quadratic.
    const auto seconds = [](const Surface& s) { return test::processor_seconds([&] { find_symmetry(s); }); };
    CHECK(seconds(test::icosphere(1, 5)) < 5);
    CHECK(seconds(tessellate(test::box({1, 1, 1}), 0.02, 20000).surface) < 10);
    CHECK(seconds(tessellate(test::sample("paddle.glb"), 1e-4, 200000).surface) < 10);
    // Rough by as much as a chord may be: anything might be an axis, and nothing is. 1.1 s; 7 s without early ends.
    Surface rough = test::icosphere(1, 5);
    for (std::size_t i = 0; i < rough.vertices.size(); ++i)
        rough.vertices[i] = rough.vertices[i] * (1 + 0.015 * std::sin(1e3 * static_cast<double>(i * i % 1009)));
    CHECK(seconds(rough) < 10);
}
