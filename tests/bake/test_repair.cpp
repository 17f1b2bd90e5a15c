// What repair() does beyond joining and turning: holes, inner walls, cuts; what it marks when it refuses; thickness.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "bake/mesh/cuts.h"
#include "bake/mesh/glb_writer.h"
#include "bake/mesh/gltf.h"
#include "bake/mesh/problem.h"
#include "bake/mesh/repair.h"
#include "bake/mesh/thickness.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;
using test::inside_out;
using test::joined;

namespace {

bool mentions(const std::vector<std::string>& notes, const std::string& text) {
    return std::any_of(notes.begin(), notes.end(),
                       [&](const std::string& n) { return n.find(text) != std::string::npos; });
}

MeshError refusal(const Surface& surface) {
    try {
        repair(surface, "thing");
    } catch (const MeshError& e) {
        return e;
    }
    return {"nothing was refused", {}, {}};
}

bool has(const MeshError& error, const std::string& text) {
    return std::string(error.what()).find(text) != std::string::npos;
}

// Takes the triangles with this corner away.
Surface without_corner(Surface s, std::uint32_t corner) {
    s.triangles.erase(std::remove_if(s.triangles.begin(), s.triangles.end(),
                                     [&](const Triangle& t) { return std::count(t.begin(), t.end(), corner) != 0; }),
                      s.triangles.end());
    return s;
}

// What is written and read again is the same but for single precision.
Surface written_and_read(const std::string& bytes) {
    const auto number = std::chrono::steady_clock::now().time_since_epoch().count();
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("frm-repair-" + std::to_string(number) + ".glb");
    std::ofstream(path, std::ios::binary) << bytes;
    const Surface surface = load_gltf(path.string());
    std::filesystem::remove(path);
    return surface;
}

}  // namespace

TEST_CASE("tiny holes are closed", "[repair][holes]") {
    const Surface sphere = test::icosphere(0.05, 5);  // 20,480 triangles of 1.7 mm
    const double volume = measure(sphere).volume;

    Surface two = sphere;
    two.triangles.erase(two.triangles.begin() + 10000);
    two.triangles.erase(two.triangles.begin() + 17);
    const Repaired closed = repair(two, "two");
    CHECK(closed.surface.triangles.size() == sphere.triangles.size());
    CHECK(measure(closed.surface).volume == Approx(volume).epsilon(1e-12));
    CHECK(closed.notes.size() == 1);
    CHECK(mentions(closed.notes, "closed 2 holes of at most 1."));
    CHECK(mentions(closed.notes, " mm, near ("));

    // A corner and its ring: the patch is flat, so a little of the ball is lost, less than the ring's area times the
    // sagitta of an arc of 3.5 mm.
    const Repaired ring = repair(without_corner(sphere, 5000), "ring");
    const double lost = volume - measure(ring.surface).volume;
    CHECK(lost > 0);
    CHECK(lost < 12e-6 * (0.05 - std::sqrt(0.05 * 0.05 - 1.75e-3 * 1.75e-3)));
    CHECK(mentions(ring.notes, "closed 1 hole of at most 3."));

    // Two holes that meet in a corner, and a hole in a surface that is inside out.
    Surface meeting;
    meeting.vertices = sphere.vertices;
    int taken = 0;
    for (const Triangle& t : sphere.triangles) {
        const bool at_corner = std::count(t.begin(), t.end(), 5000u) != 0;
        if (at_corner && (taken++ == 0 || taken == 4)) continue;
        meeting.triangles.push_back(t);
    }
    CHECK(meeting.triangles.size() == sphere.triangles.size() - 2);
    CHECK(measure(repair(meeting, "meeting").surface).volume == Approx(volume).epsilon(1e-12));
    const Repaired inward = repair(inside_out(two), "inward");
    CHECK(measure(inward.surface).volume == Approx(volume).epsilon(1e-12));
    CHECK_FALSE(mentions(inward.notes, "neighbours"));  // the patches were made to fit
}

TEST_CASE("larger holes are refused with their rims marked", "[repair][holes]") {
    // Triangles of 28 mm in a ball of 100 mm.
    Surface ball = test::icosphere(0.05, 1);
    const Triangle lost = ball.triangles[33];
    const Vec3d middle = (ball.vertices[lost[0]] + ball.vertices[lost[1]] + ball.vertices[lost[2]]) / 3.0;
    ball.triangles.erase(ball.triangles.begin() + 33);
    const MeshError error = refusal(ball);
    CHECK(has(error, "thing: the surface is open: 3 boundary edges around 1 hole"));
    CHECK(has(error, "only under 5 mm and 0.1 % of the surface"));
    REQUIRE(error.marks().edges.size() == 3);
    for (const auto& edge : error.marks().edges) {
        for (const Vec3d& end : edge) CHECK(length(end - middle) < 0.02);
    }
    CHECK(error.surface().triangles == ball.triangles);

    // Tiny ones are not named where a large one stays open.
    Surface both = test::icosphere(0.05, 5);
    both.triangles.erase(both.triangles.begin() + 9000);
    const MeshError mixed = refusal(joined(both, test::moved(ball, {0.2, 0, 0})));
    CHECK(mixed.marks().edges.size() == 3);

    // Shreds: each hole is tiny, together they are more than a percent.
    Surface sieve = test::icosphere(0.05, 5);
    const std::vector<Triangle> whole = sieve.triangles;
    sieve.triangles.clear();
    for (std::size_t t = 0; t < whole.size(); ++t) {
        if (t % 64 != 63) sieve.triangles.push_back(whole[t]);
    }
    CHECK(has(refusal(sieve), "open: 960 boundary edges"));
}

TEST_CASE("cracks of any length are closed", "[repair][holes]") {
    // One side of a box's edge has ten more vertices than the other, straight or 0.05 mm off; the box is a metre.
    for (const double off : {0.0, 5e-5}) {
        INFO(off);
        Surface box = test::box({1, 1, 1});
        // Triangle 4 is (0, 1, 5): its side from 0 to 1 is an edge of the box.
        REQUIRE(box.triangles[4] == Triangle{0, 1, 5});
        std::uint32_t before = 0;
        box.triangles.erase(box.triangles.begin() + 4);
        for (int i = 1; i <= 10; ++i) {
            const auto next = static_cast<std::uint32_t>(box.vertices.size());
            box.vertices.push_back({-0.5 + i / 11.0, -0.5 - off, -0.5});
            box.triangles.push_back({before, next, 5});
            before = next;
        }
        box.triangles.push_back({before, 1, 5});
        const Repaired closed = repair(box, "crack");
        CHECK(mentions(closed.notes, "closed 1 crack under 0.1 mm wide on average, near (-0.5, -0.5, -0.5) m"));
        CHECK(measure(closed.surface).volume == Approx(1).epsilon(1e-4));
        CHECK(closed.cuts.within == 0);
    }
}

TEST_CASE("a patch that would fold or cut leaves the hole open", "[repair][holes]") {
    // A loose triangle is its own rim; closing it would lay a second one on it.
    Surface stray = test::icosphere(0.05, 4);
    const auto base = static_cast<std::uint32_t>(stray.vertices.size());
    for (const Vec3d& v : {Vec3d(0.07, 0, 0), Vec3d(0.073, 0, 0), Vec3d(0.07, 0.003, 0)}) stray.vertices.push_back(v);
    stray.triangles.push_back({base, base + 1, base + 2});
    const MeshError folded = refusal(stray);
    REQUIRE(folded.marks().edges.size() == 3);
    CHECK(folded.marks().edges[0][0].x >= 0.07);

    // A thorn from elsewhere stands in the hole.
    Surface pierced = test::icosphere(0.05, 5);
    const Triangle gone = pierced.triangles[4000];
    const Vec3d middle = (pierced.vertices[gone[0]] + pierced.vertices[gone[1]] + pierced.vertices[gone[2]]) / 3.0;
    pierced.triangles.erase(pierced.triangles.begin() + 4000);
    const Surface thorn = test::moved(test::box({2e-4, 2e-4, 2e-4}), middle);
    CHECK(measure(repair(pierced, "hole").surface).volume > 0);
    CHECK(has(refusal(joined(pierced, thorn)), "open: 3 boundary edges"));
}

TEST_CASE("walls inside are removed", "[repair][walls]") {
    // Two boxes with one wall between them, not two back to back.
    const Surface box = test::box({1, 1, 1});
    Surface open = test::moved(box, {1, 0, 0});
    open.triangles.erase(open.triangles.begin(), open.triangles.begin() + 2);  // its side at -x
    const Repaired hull = repair(joined(box, open), "hull");
    CHECK(mentions(hull.notes, "removed 2 triangles of walls inside"));
    CHECK(hull.surface.triangles.size() == 20);
    CHECK(measure(hull.surface).volume == Approx(2));

    // Two bulkheads, in any winding, turned so that no axis helps.
    Surface three = joined(joined(box, open), test::moved(open, {1, 0, 0}));
    std::swap(three.triangles[2][0], three.triangles[2][1]);
    const Repaired turned = repair(test::rotated(three, {1, 2, 3}, 0.7), "hull");
    CHECK(turned.surface.triangles.size() == 28);
    CHECK(measure(turned.surface).volume == Approx(3));

    // A bulkhead of two sheets that bulge apart: four triangles at each edge of its rim, so nothing is open.
    Surface bulging = joined(box, open);
    bulging.triangles.erase(bulging.triangles.begin() + 2, bulging.triangles.begin() + 4);  // its side at +x
    bulging.vertices.push_back({0.4, 0, 0});
    bulging.vertices.push_back({0.6, 0, 0});
    for (const std::uint32_t tip : {16u, 17u}) {
        for (const Triangle& t : {Triangle{1, 3, tip}, {3, 7, tip}, {7, 5, tip}, {5, 1, tip}})
            bulging.triangles.push_back(t);
    }
    const Repaired flush = repair(bulging, "hull");
    CHECK(mentions(flush.notes, "removed 8 triangles of walls inside"));
    CHECK(measure(flush.surface).volume == Approx(2));

    // Three pages on one spine, all inside the double pyramid whose edges they share.
    Surface pages;
    pages.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0.5}, {-1, 1, 0.5}, {-1, -1, 0.5}};
    pages.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {0, 2, 3}, {0, 3, 4},
                       {0, 4, 2}, {1, 2, 3}, {1, 3, 4}, {1, 4, 2}};
    CHECK(repair(pages, "pages").surface.triangles.size() == 6);

    // A rib with a free edge, and a loose sheet, inside.
    Surface rib = box;
    rib.vertices.push_back({0, 0, 0.2});
    rib.vertices.push_back({0.1, 0.1, -0.2});
    rib.vertices.push_back({0.3, 0, 0.2});
    rib.triangles.push_back({0, 1, 8});
    rib.triangles.push_back({8, 9, 10});
    const Repaired inside = repair(rib, "rib");
    CHECK(inside.surface.triangles.size() == 12);
    CHECK(mentions(inside.notes, "removed 2 triangles of walls inside"));

    // Walls and a tiny hole at once: a ball of 0.1 m with a loose disc in it.
    Surface ball = test::icosphere(0.05, 5);
    ball.triangles.erase(ball.triangles.begin() + 77);
    const auto base = static_cast<std::uint32_t>(ball.vertices.size());
    for (const Vec3d& v : {Vec3d(0, 0, 0), Vec3d(0.02, 0, 0), Vec3d(0, 0.02, 0)}) ball.vertices.push_back(v);
    ball.triangles.push_back({base, base + 1, base + 2});
    const Repaired filled = repair(ball, "ball");
    CHECK(filled.surface.triangles.size() == 20480);
    CHECK(filled.notes.size() == 2);
}

TEST_CASE("walls that are not inside are refused and marked", "[repair][walls]") {
    const Surface box = test::box({1, 1, 1});
    Surface fin = box;
    fin.vertices.push_back({0, 0, 3});
    fin.triangles.push_back({4, 5, 8});
    const MeshError outside = refusal(fin);
    CHECK(has(outside, "open: 2 boundary edges"));
    CHECK(outside.marks().edges.size() == 3);  // its free edges, and the one where it joins the box

    // A tent from the rim of the lid, down through the floor: its tip is outside.
    Surface tent = box;
    tent.vertices.push_back({0.1, 0.05, -4});
    for (const Triangle& t : {Triangle{4, 5, 8}, {5, 7, 8}, {7, 6, 8}, {6, 4, 8}}) tent.triangles.push_back(t);
    const MeshError through = refusal(tent);
    CHECK(has(through, "4 edges shared by more than two triangles"));
    CHECK(has(through, ", 0.5) m by 3"));
    REQUIRE(through.marks().edges.size() == 4);
    for (const auto& edge : through.marks().edges) CHECK((edge[0].z == 0.5 && edge[1].z == 0.5));

    // Loose in the box, with its middle inside and a corner out of it.
    Surface poking = box;
    for (const Vec3d& v : {Vec3d(0, 0, 0), Vec3d(0.2, 0, 0.1), Vec3d(0.1, 0.9, 0.1)}) poking.vertices.push_back(v);
    poking.triangles.push_back({8, 9, 10});
    CHECK(has(refusal(poking), "open sheet without thickness (a sail, a leaf, one side of a plate): 3 boundary edges"));

    // Two tubes of one piece along one edge: which belongs to which cannot be told.
    Surface pinched = joined(box, test::moved(box, {1, 1, 0}));
    const Surface bridge = test::moved(test::box({1, 1, 1}), {0, 0, 1});
    pinched = joined(joined(pinched, bridge), joined(test::moved(bridge, {1, 0, 0}), test::moved(bridge, {1, 1, 0})));
    const MeshError crowded = refusal(pinched);
    CHECK(has(crowded, "four triangles or more"));
    REQUIRE(crowded.marks().edges.size() >= 1);
    for (const auto& edge : crowded.marks().edges) {
        for (const Vec3d& end : edge) CHECK((end.x == 0.5 && end.y == 0.5));
    }
}

TEST_CASE("sheets are refused, all of them marked", "[repair]") {
    // A sail: curved, so not flat.
    Surface sail;
    constexpr std::uint32_t n = 8;
    for (std::uint32_t i = 0; i <= n; ++i) {
        for (std::uint32_t j = 0; j <= n; ++j)
            sail.vertices.push_back({i / 8.0, j / 8.0, 0.1 * std::sin(0.39 * i) * std::sin(0.39 * j)});
    }
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < n; ++j) {
            const std::uint32_t a = i * (n + 1) + j, b = a + n + 1;
            sail.triangles.push_back({a, b, b + 1});
            sail.triangles.push_back({a, b + 1, a + 1});
        }
    }
    const MeshError error = refusal(sail);
    CHECK(has(error, "open sheet without thickness"));
    CHECK(has(error, "Solidify"));
    CHECK(error.marks().edges.size() == 32);
    // The same beside a sound body, which does not make it a vessel.
    CHECK(has(refusal(joined(test::moved(test::box({3, 3, 3}), {9, 0, 0}), sail)), "open sheet without thickness"));

    Surface flat = sail;
    for (Vec3d& v : flat.vertices) v.z = 0;
    const MeshError plane = refusal(flat);
    CHECK(has(plane, "flat sheet"));
    CHECK(plane.marks().triangles.size() == 128);
    // Only the sheet is marked, not the box that comes with it.
    const MeshError beside = refusal(joined(test::box({1, 1, 1}), test::moved(test::box({1, 1, 8e-6}), {3, 0, 0})));
    CHECK(has(beside, "the piece near (2.5"));
    CHECK(beside.marks().triangles.size() == 12);
    // So thin that joining vertices lays its sides on each other, and a sheet drawn for both sides.
    CHECK(has(refusal(joined(test::box({1, 1, 1}), test::moved(test::box({1, 1, 1e-6}), {3, 0, 0}))),
              "the piece near (2.5"));
    const MeshError both =
        refusal(joined(test::box({1, 1, 1}), test::moved(joined(flat, inside_out(flat)), {3, 0, 0})));
    CHECK(has(both, "is a flat sheet"));
    CHECK(both.marks().triangles.size() == 256);
}

TEST_CASE("which triangles cut", "[repair][cuts]") {
    const std::vector<Vec3d> v = {{0, 0, 0},       {1, 0, 0},      {0, 1, 0},    {0.2, 0.2, -1}, {0.2, 0.2, 1},
                                  {0.3, 0.9, 1},   {0.3, 0.9, 0},  {2, 2, -1},   {2, 2, 1},      {0.25, 0.25, 0.5},
                                  {-1, 0.1, -0.3}, {1, 0.4, -0.3}, {1, 0.4, 0.9}};
    const Triangle floor = {0, 1, 2};
    const auto cut = [&](const Triangle& t) {
        CHECK(triangles_cut(v, floor, t, 1e-6) == triangles_cut(v, t, floor, 1e-6));
        return triangles_cut(v, floor, t, 1e-6);
    };
    CHECK(cut({3, 4, 5}));        // an edge through the middle
    CHECK(cut({10, 11, 12}));     // and one whose slanting side passes through
    CHECK_FALSE(cut({4, 5, 6}));  // a corner rests in the plane, beside it
    CHECK_FALSE(cut({9, 4, 5}));  // above
    CHECK_FALSE(cut({7, 8, 5}));  // through the plane, but outside
    CHECK_FALSE(cut({1, 2, 4}));  // shares an edge
    CHECK_FALSE(cut({0, 4, 9}));  // shares a corner and stands on it
    CHECK(cut({0, 3, 4}));        // shares a corner; its far side cuts
}

TEST_CASE("cuts are found and said, not refused", "[repair][cuts]") {
    for (const Surface& sound : {test::icosphere(0.05, 4), test::box({1, 2, 3}), test::cylinder(0.1, 1, 90)})
        CHECK(repair(sound, "sound").notes.empty());

    // A ball with a corner pulled through its far side. All pairs, one by one, are the second way of counting.
    Surface ball = test::icosphere(1, 3);
    ball.vertices[0] = ball.vertices[0] * -2.0;
    const Repaired pulled = repair(ball, "ball");
    std::size_t pairs = 0;
    for (std::size_t a = 0; a < pulled.surface.triangles.size(); ++a) {
        for (std::size_t b = a + 1; b < pulled.surface.triangles.size(); ++b)
            pairs +=
                triangles_cut(pulled.surface.vertices, pulled.surface.triangles[a], pulled.surface.triangles[b], 2e-6);
    }
    CHECK(pairs > 5);
    CHECK(pulled.cuts.within == pairs);
    CHECK(pulled.cuts.between == 0);
    CHECK(pulled.cuts.complete);
    REQUIRE(pulled.notes.size() == 1);
    CHECK(mentions(pulled.notes, "cuts through itself: " + std::to_string(pairs) + " pairs of triangles, near ("));

    const Surface box = test::box({1, 1, 1});
    const Repaired crossing = repair(joined(box, test::moved(box, {0.5, 0.3, 0.2})), "two");
    CHECK(crossing.cuts.within == 0);
    CHECK(crossing.cuts.between > 3);
    CHECK(mentions(crossing.notes, "pieces run into each other"));
    // Mirror images of each other: edges meet edges all round.
    const Surface round = test::icosphere(0.05, 3);
    for (const Vec3d& by : {Vec3d(0.03, 0, 0), Vec3d(0.05, 0, 0), Vec3d(0, 0.04, 0)}) {
        const Repaired mirrored = repair(joined(round, test::moved(round, by)), "two");
        CHECK(mirrored.cuts.between > 20);
        CHECK(mentions(mirrored.notes, "pieces run into each other"));
    }
    for (const Vec3d& by : {Vec3d(0.1, 0, 0), Vec3d(0.100001, 0, 0)})  // they touch in a corner, or do not
        CHECK(repair(joined(round, test::moved(round, by)), "two").notes.empty());
    for (const Vec3d& by : {Vec3d(1, 0.3, 0.2), Vec3d(1, 1, 0), Vec3d(3, 0, 0)})  // a face, an edge, nothing in common
        CHECK(repair(joined(box, test::moved(box, by)), "two").notes.empty());
}

TEST_CASE("a problem file shows the surface and the place", "[repair][problem]") {
    Surface open = test::box({0.4, 0.3, 0.2});
    open.triangles.resize(10);  // no lid at +z
    const MeshError error = refusal(open);
    REQUIRE(error.marks().edges.size() == 4);
    const std::string bytes = problem_glb(error);
    CHECK(bytes.find(kProblemGenerator) < 256);
    const Surface all = written_and_read(bytes);
    // The surface comes first, then a block of twelve triangles for each edge.
    CHECK(all.triangles.size() == 10 + 4 * 12);
    const auto red = [&](std::size_t t) { return t >= 10; };
    Vec3d low{1, 1, 1}, high{-1, -1, -1};
    for (std::size_t t = 0; t < all.triangles.size(); ++t) {
        for (int i = 0; i < 3; ++i) {
            const Vec3d p = all.corner(t, i);
            if (!red(t)) continue;
            CHECK(std::fabs(p.z - 0.1) < 0.003 * 0.4);
            CHECK(std::max(std::fabs(p.x) / 0.2, std::fabs(p.y) / 0.15) > 0.98);
            for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
        }
    }
    CHECK(high.x - low.x == Approx(0.4 + 2 * 0.0012));
    CHECK(high.y - low.y == Approx(0.3 + 2 * 0.0012));

    // Plates and points, of which the blocks are closed surfaces themselves.
    Marks marks;
    marks.points = {{0, 0, 0}};
    marks.triangles = {{Vec3d(0, 0, 0.1), Vec3d(0.1, 0, 0.1), Vec3d(0, 0.1, 0.1)}};
    const Surface drawn = written_and_read(problem_glb({"both", test::box({0.4, 0.3, 0.2}), marks}));
    CHECK(repair(drawn, "drawn").surface.triangles.size() == 12 + 8);  // the point is inside the box, the plate is half
    // Very many marks are thinned out.
    marks.edges.assign(100000, {Vec3d(0, 0, 0), Vec3d(0, 0, 0.1)});
    CHECK(problem_glb({"many", test::box({0.4, 0.3, 0.2}), marks}).size() < 8'000'000);
}

TEST_CASE("a written surface is the same when it is read", "[repair][glb]") {
    const Surface ball = test::moved(test::icosphere(0.05, 3), {1, 2, 3});
    const Surface read = written_and_read(write_glb({{"ball", {1, 1, 1, 1}, &ball}}, "test \"of\" names"));
    // The reader numbers vertices as triangles use them, so the corners are compared.
    REQUIRE(read.triangles.size() == ball.triangles.size());
    CHECK(read.vertices.size() == ball.vertices.size());
    double most = 0;
    for (std::size_t t = 0; t < read.triangles.size(); ++t) {
        for (int i = 0; i < 3; ++i) most = std::max(most, length(read.corner(t, i) - ball.corner(t, i)));
    }
    CHECK(most < 3e-7);
    const Surface none;
    CHECK_THROWS_AS(write_glb({{"none", {1, 1, 1, 1}, &none}}, "test"), BakeError);
    const Surface far_away = test::moved(ball, {1e300, 0, 0});
    CHECK_THROWS_AS(write_glb({{"far", {1, 1, 1, 1}, &far_away}}, "test"), BakeError);
}

TEST_CASE("thickness", "[mesh][thickness]") {
    const Thickness plate = measure_thickness(test::box({0.3, 0.2, 0.01}));
    CHECK(plate.thinnest == Approx(0.01));
    CHECK(plate.median == Approx(0.01));
    CHECK(std::fabs(plate.thinnest_at.z) == Approx(0.005));
    // The depth of a ball under any point is its diameter; a polyhedron's is a little less.
    const Thickness ball = measure_thickness(test::icosphere(0.05, 4));
    CHECK(ball.thinnest > 0.098);
    CHECK(ball.median <= 0.1);
    // A plate of a tenth of the other's thickness, 5 % of the surface; and through pieces that overlap.
    const Surface thin = test::moved(test::box({0.1, 0.05, 0.001}), {1, 0, 0});
    const Thickness two = measure_thickness(joined(test::box({0.3, 0.3, 0.01}), thin));
    CHECK(two.thinnest == Approx(0.001));
    CHECK(two.thinnest_at.x > 0.9);
    const Surface block = test::box({1, 1, 1});
    const Thickness overlapping = measure_thickness(joined(block, test::moved(block, {0.5, 0, 0})));
    CHECK(overlapping.thinnest == Approx(1));
    CHECK(overlapping.median == Approx(1));
}
