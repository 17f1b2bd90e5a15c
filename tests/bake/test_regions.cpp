// Tessellation keeps the shape and has no cracks; regions are a partition into connected, similar patches.
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "bake/mesh/adjacency.h"
#include "bake/regions/regions.h"
#include "bake/regions/tessellate.h"
#include "tests/support/catch.h"
#include "tests/support/samples.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;

namespace {

// So fine that a region has about forty triangles.
Surface fine_enough(const Surface& surface, std::uint32_t regions) {
    return tessellate(surface, 1.5 * std::sqrt(measure(surface).area / (40.0 * regions)), 100000).surface;
}

Vec3d area_vector(const Surface& s, std::size_t t) {
    return cross(s.corner(t, 1) - s.corner(t, 0), s.corner(t, 2) - s.corner(t, 0)) * 0.5;
}

// How many connected pieces the regions have in all; their count when each is connected.
std::uint32_t connected_pieces(const Surface& s, const Regions& regions) {
    const Neighbours neighbours = find_neighbours(s, "test");
    std::vector<char> seen(s.triangles.size(), 0);
    std::uint32_t pieces = 0;
    for (std::uint32_t first = 0; first < seen.size(); ++first) {
        if (seen[first]) continue;
        ++pieces;
        std::vector<std::uint32_t> queue(1, first);
        seen[first] = 1;
        while (!queue.empty()) {
            const std::uint32_t t = queue.back();
            queue.pop_back();
            for (const std::uint32_t n : neighbours[t]) {
                if (seen[n] || regions.region[n] != regions.region[first]) continue;
                seen[n] = 1;
                queue.push_back(n);
            }
        }
    }
    return pieces;
}

void check_partition(const Surface& s, std::uint32_t count, double most_uneven) {
    const Regions regions = split_regions(s, count);
    CHECK(regions.count == count);
    REQUIRE(regions.region.size() == s.triangles.size());
    CHECK(std::set<std::uint32_t>(regions.region.begin(), regions.region.end()).size() == count);
    CHECK(*std::max_element(regions.region.begin(), regions.region.end()) == count - 1);
    CHECK(connected_pieces(s, regions) == count);

    const std::vector<RegionProperties> properties = region_properties(s, regions);
    const double mean = measure(s).area / count;
    double sum = 0, least = 1e9, most = 0;
    for (const RegionProperties& p : properties) {
        sum += p.area;
        least = std::min(least, p.area);
        most = std::max(most, p.area);
        CHECK((length(p.normal) == Approx(1) || length(p.normal) == 0));
    }
    CHECK(sum == Approx(measure(s).area));
    CHECK(most < mean * most_uneven);
    CHECK(least > mean / most_uneven);
}

}  // namespace

TEST_CASE("tessellation keeps the shape and stays closed", "[tessellate]") {
    struct Case {
        Surface surface;
        double edge;
    };
    for (const Case& c : {Case{test::box({0.4, 0.3, 0.2}), 0.03},
                          {test::cylinder(0.02, 1, 24), 0.02},
                          {test::icosphere(1, 2), 0.1},
                          {test::sample("paddle.glb"), 0.012},
                          {test::box({1, 1, 0.001}), 0.05}}) {
        const Tessellation fine = tessellate(c.surface, c.edge, 1000000);
        const SurfaceProperties before = measure(c.surface), after = measure(fine.surface);
        CHECK(after.volume == Approx(before.volume).epsilon(1e-10));
        CHECK(after.area == Approx(before.area).epsilon(1e-10));
        CHECK(fine.longest_edge <= c.edge);
        CHECK(fine.longest_edge > c.edge / 2);
        CHECK_NOTHROW(find_neighbours(fine.surface, "test"));
        // One way round, still: each side is met once in each direction.
        std::set<std::pair<std::uint32_t, std::uint32_t>> sides;
        for (const Triangle& t : fine.surface.triangles) {
            for (std::size_t i = 0; i < 3; ++i) sides.insert({t[i], t[(i + 1) % 3]});
        }
        CHECK(sides.size() == 3 * fine.surface.triangles.size());
        REQUIRE(fine.source.size() == fine.surface.triangles.size());
        CHECK(std::is_sorted(fine.source.begin(), fine.source.end()));
        for (std::size_t t = 0; t < fine.source.size(); t += 7) {
            const Vec3d from = area_vector(c.surface, fine.source[t]), part = area_vector(fine.surface, t);
            CHECK(dot(from, part) >= (1 - 1e-6) * length(from) * length(part));
        }
    }
}

TEST_CASE("tessellation of coarse or capped surfaces", "[tessellate]") {
    const Surface box = test::box({0.4, 0.3, 0.2});
    CHECK(tessellate(box, 10, 1000).surface.triangles == box.triangles);
    CHECK(tessellate(box, 0.001, 5).surface.triangles == box.triangles);
    const Tessellation capped = tessellate(box, 0.001, 1000);
    CHECK(capped.surface.triangles.size() <= 1000);
    CHECK(capped.surface.triangles.size() > 900);
    CHECK(capped.longest_edge > 0.02);
    CHECK(capped.longest_edge < 0.06);
    CHECK(tessellate(box, 0.02, 100000).surface.triangles == tessellate(box, 0.02, 100000).surface.triangles);
    CHECK_THROWS_AS(tessellate(box, 0, 1000), BakeError);
    CHECK_THROWS_AS(tessellate(box, NAN, 1000), BakeError);
    Surface open = box;
    open.triangles.pop_back();
    CHECK_THROWS_AS(tessellate(open, 0.1, 1000), BakeError);
}

TEST_CASE("regions are connected, as many as asked for, and of similar area", "[regions]") {
    for (const std::uint32_t count : {1u, 2u, 6u, 13u, 40u, 150u}) {
        INFO(count);
        check_partition(fine_enough(test::icosphere(0.05, 2), count), count, 1.5);
        check_partition(fine_enough(test::box({0.4, 0.3, 0.2}), count), count, 2);
        check_partition(fine_enough(test::sample("paddle.glb"), count), count, 3);
    }
    check_partition(fine_enough(test::sample("canoe.glb"), 60), 60, 5);
    check_partition(fine_enough(test::cylinder(0.015, 0.5, 32), 30), 30, 2.5);
}

TEST_CASE("a box in six regions has its faces", "[regions]") {
    const Surface box = fine_enough(test::box({0.4, 0.3, 0.2}), 6);
    const std::vector<RegionProperties> properties = region_properties(box, split_regions(box, 6));
    for (const RegionProperties& p : properties) {
        const double largest = std::max({std::fabs(p.normal.x), std::fabs(p.normal.y), std::fabs(p.normal.z)});
        CHECK(largest == Approx(1));
        CHECK(dot(p.centre, p.normal) == Approx(length(p.centre)));
    }
}

TEST_CASE("front and back of a thin blade are never one region", "[regions]") {
    const auto mixed = [](const Surface& s, std::uint32_t count, double below) {
        const Regions regions = split_regions(s, count);
        std::vector<char> front(count, 0), back(count, 0);
        for (std::size_t t = 0; t < s.triangles.size(); ++t) {
            const Vec3d a = area_vector(s, t);
            const double y = a.y / length(a);
            if ((s.corner(t, 0).z + s.corner(t, 1).z + s.corner(t, 2).z) / 3 > below) continue;
            if (y > 0.8) front[regions.region[t]] = 1;
            if (y < -0.8) back[regions.region[t]] = 1;
        }
        int both = 0;
        for (std::uint32_t r = 0; r < count; ++r) both += front[r] && back[r];
        return both;
    };
    for (const std::uint32_t count : {2u, 4u, 7u, 12u, 40u, 100u}) {
        INFO(count);
        CHECK(mixed(fine_enough(test::box({0.08, 0.01, 0.3}), count), count, 1) == 0);
    }
    const Surface paddle = test::sample("paddle.glb");
    for (const std::uint32_t count : {8u, 12u, 20u, 40u, 100u}) {
        INFO(count);
        CHECK(mixed(fine_enough(paddle, count), count, -0.5) == 0);
    }
}

TEST_CASE("regions of several shells", "[regions]") {
    Surface two = test::box({1, 1, 1});
    const Surface small = test::moved(test::box({0.5, 0.5, 0.5}), {2, 0, 0});
    for (const Triangle& t : small.triangles) two.triangles.push_back({t[0] + 8, t[1] + 8, t[2] + 8});
    two.vertices.insert(two.vertices.end(), small.vertices.begin(), small.vertices.end());
    check_partition(fine_enough(two, 10), 10, 2);  // 8 on the large one, 2 on the small one
    const Regions one = split_regions(two, 1);
    CHECK(region_properties(two, one)[0].area == Approx(7.5));
    CHECK(connected_pieces(two, one) == 2);
}

TEST_CASE("the same regions every time; refusals", "[regions]") {
    const Surface paddle = test::sample("paddle.glb");
    CHECK(split_regions(paddle, 50).region == split_regions(paddle, 50).region);

    const Surface box = test::box({1, 1, 1});
    const Regions all = split_regions(box, 12);
    CHECK(std::set<std::uint32_t>(all.region.begin(), all.region.end()).size() == 12);
    CHECK_THROWS_AS(split_regions(box, 13), BakeError);
    CHECK_THROWS_AS(split_regions(box, 0), BakeError);
    CHECK_THROWS_AS(split_regions(tessellate(box, 0.05, 100000).surface, kMostRegions + 1), BakeError);
    CHECK_THROWS_AS(region_properties(box, Regions{{0, 0}, 1}), BakeError);
    const Surface many = test::icosphere(1, 4);
    check_partition(many, kMostRegions, 3);
}

TEST_CASE("a region's centre is its mean", "[regions]") {
    const Surface s = test::icosphere(0.05, 3);
    const Regions regions = split_regions(s, 20);
    const std::vector<RegionProperties> properties = region_properties(s, regions);
    Vec3d sum, normal;
    for (const RegionProperties& p : properties) {
        sum += p.centre * p.area;
        normal += p.normal * p.area;
        CHECK(dot(p.normal, p.centre) > 0.9 * length(p.centre));
        CHECK(length(p.centre) < 0.05);
        CHECK(length(p.centre) > 0.04);
    }
    CHECK(length(sum) < 1e-9);
}
