// Forces on regions that come from an image of the direction are those of the direction itself.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bake/directions/torque.h"
#include "bake/directions/transfer.h"
#include "bake/error.h"
#include "bake/regions/regions.h"
#include "bake/regions/tessellate.h"
#include "bake/symmetry/symmetry.h"
#include "tests/support/catch.h"
#include "tests/support/samples.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;

namespace {

// What a flow stands in for here: pressed where the stream meets a triangle, half sucked at the lee, and more so far
// from the centre, so that place matters too.
std::vector<Vec3d> forces(const Surface& s, const Regions& regions, const Vec3d& centre, const Vec3d& stream) {
    std::vector<Vec3d> result(regions.count);
    for (std::size_t t = 0; t < s.triangles.size(); ++t) {
        const Vec3d n = cross(s.corner(t, 1) - s.corner(t, 0), s.corner(t, 2) - s.corner(t, 0)) * 0.5;
        const double along = dot(n, stream), size = length(n);
        const Vec3d off = (s.corner(t, 0) + s.corner(t, 1) + s.corner(t, 2)) / 3.0 - centre;
        const double place = 1 + dot(off, stream) / (length(off) + 1e-9);
        if (size > 0)
            result[regions.region[t]] += n * (along * along / (size * size) * (along < 0 ? -1.0 : 0.5) * place);
    }
    return result;
}

// The root mean square error of regions' forces, as a share of the root mean square of the forces.
double error_of(const Surface& s, const Regions& regions, double* of_whole = nullptr) {
    const Symmetry symmetry = find_symmetry(s);
    const std::vector<Vec3d> streams = {{0.2, 0.3, 0.93}, {-0.6, 0.5, -0.62}, {0.1, -0.9, 0.42}, {-0.8, -0.6, 0}};
    std::vector<Canonical> homes;
    std::vector<Matrix3> elements;
    for (const Vec3d& d : streams) {
        homes.push_back(canonical(symmetry, d));
        elements.push_back(homes.back().element);
    }
    const Landing landing(s, symmetry.tolerance);
    const Regions patches = patches_for(s, regions, elements, symmetry.centre, landing);
    double difference = 0, all = 0;
    for (std::size_t i = 0; i < streams.size(); ++i) {
        const std::vector<Vec3d> on_patches = forces(s, patches, symmetry.centre, homes[i].direction);
        std::vector<Vec3d> result(regions.count);
        const Transfer transfer({s, patches, regions, symmetry.centre, landing}, elements[i]);
        for (const Transfer::Share& part : transfer.shares())
            result[part.region] += homes[i].element * on_patches[part.patch] * part.share;
        const std::vector<Vec3d> expected = forces(s, regions, symmetry.centre, streams[i] / length(streams[i]));
        Vec3d whole, whole_expected;
        for (std::uint32_t l = 0; l < regions.count; ++l) {
            difference += dot(result[l] - expected[l], result[l] - expected[l]);
            all += dot(expected[l], expected[l]);
            whole += result[l];
            whole_expected += expected[l];
        }
        if (of_whole) *of_whole = std::max(*of_whole, length(whole - whole_expected) / length(whole_expected));
    }
    return std::sqrt(difference / all);
}

}  // namespace

TEST_CASE("carried forces of regions are those of the direction", "[transfer]") {
    for (const char* name : {"paddle.glb", "plate.glb", "canoe.glb", "box.glb", "sphere.glb"}) {
        const Surface s = sample_triangles(test::sample(name));
        double whole = 0;
        const double error = error_of(s, split_regions(s, 40), &whole);
        INFO(name << ": regions " << error << ", whole " << whole);
        // The whole force is off only by what the surface is off its image, that of regions also by the triangles at
        // their borders: a region of 50 triangles has some 25 of them there, each off by a part of its area either way.
        CHECK(whole < 0.01);
        CHECK(error < 0.1);
    }
    // And of finer triangles less.
    const Surface box = test::box({0.4, 0.3, 0.2});
    const double coarse = error_of(sample_triangles(box, 500), split_regions(sample_triangles(box, 500), 20));
    const Surface fine = sample_triangles(tessellate(box, 0.012, 20000).surface, 20000);
    CHECK(error_of(fine, split_regions(fine, 20)) < 0.5 * coarse);
}

TEST_CASE("patches are carried whole, and all go somewhere", "[transfer]") {
    const Surface s = sample_triangles(test::sample("plate.glb"));
    const Regions regions = split_regions(s, 24);
    const Symmetry symmetry = find_symmetry(s);
    REQUIRE(symmetry.elements.size() == 8);
    const Landing landing(s, symmetry.tolerance);
    const Regions patches = patches_for(s, regions, symmetry.elements, symmetry.centre, landing);
    CHECK(patches.region.size() == s.triangles.size());
    CHECK(patches.count > regions.count);
    const Carrier carrier{s, patches, regions, symmetry.centre, landing};
    for (const Matrix3& g : symmetry.elements) {
        const Transfer transfer(carrier, g);
        CHECK(transfer.shares().size() == patches.count);
        for (const Transfer::Share& part : transfer.shares()) CHECK(part.share == Approx(1));
    }
    // Of patches that were not made for it a part goes to each of several regions; none is lost.
    const Regions others = split_regions(s, 60);
    std::vector<double> sum(others.count, 0.0);
    const Transfer shared({s, others, regions, symmetry.centre, landing}, symmetry.elements[1]);
    for (const Transfer::Share& part : shared.shares()) sum[part.patch] += part.share;
    for (const double whole : sum) CHECK(whole == Approx(1));

    // By the identity alone the patches are the regions.
    const Regions same = patches_for(s, regions, {Matrix3{}}, symmetry.centre, landing);
    CHECK(same.count == regions.count);
    CHECK(same.region == regions.region);
    CHECK_THROWS_AS(patches_for(s, {{0, 1}, 2}, {Matrix3{}}, symmetry.centre, landing), BakeError);
    CHECK_THROWS_AS(Landing(s, -1), BakeError);
}

TEST_CASE("the sides of a blade thinner than the tolerance are not mixed up", "[transfer]") {
    const Surface s = sample_triangles(test::box({1, 0.6, 0.002}), 1000);
    Regions sides{{}, 3};
    for (std::size_t t = 0; t < s.triangles.size(); ++t) {
        const double n = cross(s.corner(t, 1) - s.corner(t, 0), s.corner(t, 2) - s.corner(t, 0)).z;
        sides.region.push_back(std::fabs(n) < 1e-9 ? 2 : n > 0 ? 0 : 1);
    }
    const Landing landing(s, 0.005);
    for (const Vec3d& normal : {Vec3d{1, 0, 0}, Vec3d{0, 0, 1}}) {
        const Transfer transfer({s, sides, sides, {}, landing}, mirror_across(normal));
        REQUIRE(transfer.shares().size() == 3);
        for (const Transfer::Share& part : transfer.shares())
            CHECK(part.region == (normal.z == 0 || part.patch == 2 ? part.patch : 1 - part.patch));
    }
}

TEST_CASE("what regions lack of a flow's torque is given back without a force", "[transfer]") {
    std::pmr::vector<Source> sources(5);
    std::vector<PatchForce> force(5);
    for (std::size_t l = 0; l < 5; ++l) {
        const auto k = static_cast<float>(l);
        sources[l].position = {0.1f * k, 0.02f * k * k, l % 2 ? 0.05f : 0.0f};
        sources[l].area = 0.01f + 0.002f * k;
        force[l] = {{1.0 + 0.1 * static_cast<double>(l), -0.3, 0.2}, {0.01, 0.02, 0}};
    }
    const Vec3d centre(0.1, 0.2, -0.1), wanted(0.3, -0.7, 0.2);
    const auto sums = [&] {
        std::pair<Vec3d, Vec3d> sum;
        for (std::size_t l = 0; l < 5; ++l) {
            const Vec3d f = force[l].pressure + force[l].friction;
            sum.first += f;
            sum.second += cross(Vec3d(sources[l].position) - centre, f);
        }
        return sum;
    };
    const Vec3d before = sums().first;
    CHECK(length(sums().second - wanted) > 0.1);
    restore_torque(force, sources, centre, wanted);
    CHECK(length(sums().first - before) < 1e-9);
    CHECK(length(sums().second - wanted) < 1e-9);

    // In a line: none can be had about it, and nothing is touched.
    for (std::size_t l = 0; l < 5; ++l) sources[l].position = {0.1f * static_cast<float>(l), 0, 0};
    const std::vector<PatchForce> as_it_was = force;
    restore_torque(force, sources, centre, {1, 0, 0});
    for (std::size_t l = 0; l < 5; ++l) CHECK(length(force[l].pressure - as_it_was[l].pressure) == 0);
}
