// The error of regions is what a force worked out triangle by triangle says, and the count that is chosen keeps it.
#include <cmath>
#include <string>

#include "bake/regions/choose.h"
#include "bake/regions/regions.h"
#include "bake/regions/tessellate.h"
#include "tests/support/catch.h"
#include "tests/support/processor_time.h"
#include "tests/support/samples.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;

namespace {

// The regions of a surface on a finer one that was cut from it.
Regions carried(const Regions& regions, const Tessellation& finer) {
    Regions result{{}, regions.count};
    for (const std::uint32_t source : finer.source) result.region.push_back(regions.region[source]);
    return result;
}

}  // namespace

TEST_CASE("a region a triangle makes no error, one region nearly all", "[region_error]") {
    const Surface s = sample_triangles(test::box({0.4, 0.3, 0.2}), 400);
    const RegionJudge judge(s);
    Regions own{{}, static_cast<std::uint32_t>(s.triangles.size())};
    for (std::uint32_t t = 0; t < own.count; ++t) own.region.push_back(t);
    const RegionErrors none = judge.measure(own);
    CHECK(none.whole < 1e-12);
    CHECK(none.wet_ratio < 1e-12);
    CHECK(none.velocity < 1e-12);
    CHECK(none.arm < 1e-12);
    const RegionErrors all = judge.measure(split_regions(s, 1));
    CHECK(all.whole > 0.4);
    CHECK(all.wet_ratio > 0.2);
    CHECK(all.velocity > 0.2);
    CHECK(all.arm > 0.2);
}

TEST_CASE("errors of regions do not hang on place, turn or size, nor on the triangles below", "[region_error]") {
    const Surface plate = sample_triangles(test::sample("plate.glb"));
    const Regions regions = split_regions(plate, 40);
    const RegionErrors errors = RegionJudge(plate).measure(regions);

    Surface large = test::moved(plate, {3, -2, 7});
    for (Vec3d& v : large.vertices) v = v * 10.0;
    const RegionErrors of_large = RegionJudge(large).measure(regions);
    CHECK(of_large.whole == Approx(errors.whole).epsilon(1e-6));
    CHECK(of_large.wet_ratio == Approx(errors.wet_ratio).epsilon(1e-6));
    CHECK(of_large.velocity == Approx(errors.velocity).epsilon(1e-6));

    // Seen in other attitudes: as many cases as there are make the mean what it is to some percent.
    const Surface turned = test::rotated(plate, {1, 2, 3}, 1.234);
    CHECK(RegionJudge(turned).measure(regions).whole == Approx(errors.whole).epsilon(0.15));

    const Tessellation finer = tessellate(plate, 0.005, 9000);
    CHECK(RegionJudge(finer.surface).measure(carried(regions, finer)).whole == Approx(errors.whole).epsilon(0.08));
}

TEST_CASE("only what varies over a region makes an error", "[region_error]") {
    // Two boxes far apart, a region each: wet as one and moving as one, nearly, but where the water cuts one of them.
    // Regions that each span both boxes are wrong in all.
    const Surface small = sample_triangles(test::box({0.1, 0.1, 0.1}), 400);
    const Surface pair = test::joined(test::moved(small, {0, 0, 5}), test::moved(small, {0, 0, -5}));
    Regions apart{{}, 2}, across{{}, 2};
    for (std::uint32_t t = 0; t < pair.triangles.size(); ++t) {
        apart.region.push_back(t < small.triangles.size() ? 0 : 1);
        across.region.push_back(t % 2);
    }
    const RegionJudge judge(pair);
    const RegionErrors good = judge.measure(apart), bad = judge.measure(across);
    CHECK(good.velocity < 0.02);
    CHECK(good.arm < 0.02);
    CHECK(bad.velocity > 0.3);
    CHECK(bad.arm > 0.3);
    CHECK(bad.wet_ratio > 2 * good.wet_ratio);
}

TEST_CASE("as many regions are chosen as the budget takes, and hardly more", "[region_error]") {
    for (const char* name : {"paddle.glb", "plate.glb", "box.glb", "canoe.glb", "sphere.glb"}) {
        const Surface s = sample_triangles(test::sample(name));
        std::uint32_t before = 0;
        for (const double error : {kDraftRegionError, kStandardRegionError, kHighRegionError}) {
            RegionBudget budget;
            budget.error = error;
            const ChosenRegions chosen = choose_regions(s, budget);
            INFO(name << ": " << chosen.regions.count << " regions for " << error);
            CHECK(chosen.reached);
            CHECK(chosen.errors.whole <= error);
            CHECK(chosen.regions.count > before);
            before = chosen.regions.count;
            const Regions again = split_regions(s, chosen.regions.count);
            CHECK(again.region == chosen.regions.region);
            CHECK(RegionJudge(s).measure(again).whole == chosen.errors.whole);
            // With a fifth fewer the budget is missed.
            CHECK(RegionJudge(s).measure(split_regions(s, chosen.regions.count * 4 / 5)).whole > error);
        }
    }
}

TEST_CASE("a budget that cannot be kept gives what there is, and says so", "[region_error]") {
    const Surface s = sample_triangles(test::box({0.4, 0.3, 0.2}), 400);
    RegionBudget budget;
    budget.error = 1e-6;
    const ChosenRegions all = choose_regions(s, budget);
    CHECK(!all.reached);
    CHECK(all.regions.count == s.triangles.size() / 4);
    budget.most = 30;
    CHECK(choose_regions(s, budget).regions.count == 30);
    budget.error = 1;
    CHECK(choose_regions(s, budget).regions.count == budget.least);
    budget.least = 1;
    CHECK(choose_regions(s, budget).regions.count == 1);
    // Fewer triangles than the least.
    budget = {};
    Surface t;
    t.vertices = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    t.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
    CHECK(choose_regions(t, budget).regions.count == 4);

    for (const RegionBudget& wrong :
         {RegionBudget{0, 6, 10}, RegionBudget{0.1, 0, 10}, RegionBudget{0.1, 11, 10}, RegionBudget{0.1, 6, 4097}})
        CHECK_THROWS_AS(choose_regions(s, wrong), BakeError);
}

TEST_CASE("regions are chosen in the time that a user does not notice", "[region_error]") {
    // 0.2 to 1 s on a busy core; the bound catches what has become quadratic.
    const Surface s = sample_triangles(test::sample("canoe.glb"));
    CHECK(test::processor_seconds([&] { choose_regions(s, {kHighRegionError, 6, 4096}); }) < 10);
}
