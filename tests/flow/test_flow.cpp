// The flow solver against literature, against itself, and against bad input.
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "bake/flow/flow.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;

namespace {

Regions one_region(const Surface& surface) {
    Regions regions;
    regions.region.assign(surface.triangles.size(), 0);
    regions.count = 1;
    return regions;
}

/// A unit stream of unit density: forces are then half the coefficient times the area.
FlowCase unit_case(double reynolds, double cells, double start_up, double duration) {
    FlowCase c;
    c.direction = {1, 0, 0};
    c.speed = 1;
    c.density = 1;
    c.viscosity = 1 / reynolds;
    c.reference_length = 1;
    c.resolution = cells;
    c.start_up = start_up;
    c.duration = duration;
    return c;
}

Vec3d mean(const std::vector<float>& values) {
    Vec3d sum;
    for (std::size_t i = 0; i < values.size(); ++i) sum[static_cast<int>(i % 3)] += static_cast<double>(values[i]);
    return values.empty() ? sum : sum * (3.0 / static_cast<double>(values.size()));
}

/// Mean force on the whole body as coefficients on the projected area.
struct Coefficients {
    Vec3d total, pressure, friction;
    explicit Coefficients(const FlowSeries& s, double density = 1, double speed = 1) {
        const double scale = s.regions / (0.5 * density * speed * speed * s.plan.projected_area);
        pressure = mean(s.pressure) * scale;
        friction = mean(s.friction) * scale;
        total = pressure + friction;
    }
};

FlowSeries solve(const Surface& surface, const FlowCase& c) {
    return solve_flow(surface, one_region(surface), c, nullptr);
}

bool same_bits(const std::vector<float>& a, const std::vector<float>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

std::string error_of(const Surface& surface, const FlowCase& c) {
    try {
        plan_flow(surface, c);
    } catch (const BakeError& e) {
        return e.what();
    }
    return {};
}

bool mentions(const std::string& text, const char* word) { return text.find(word) != std::string::npos; }

}  // namespace

TEST_CASE("a sphere at Reynolds number 100 has the drag of the literature", "[flow]") {
    const Surface sphere = test::icosphere(0.5, 4);
    const FlowSeries series = solve(sphere, unit_case(100, 14, 8, 4));
    const Coefficients c(series);
    CHECK(c.total.x == Approx(1.09).epsilon(0.10));
    CHECK(std::abs(c.total.y) < 0.02);
    CHECK(std::abs(c.total.z) < 0.02);
    const double share = c.friction.x / c.total.x;
    CHECK(share > 0.45);
    CHECK(share < 0.61);
    CHECK(series.plan.reynolds == Approx(100));
    CHECK(series.plan.reynolds_solved == Approx(100));
    CHECK(series.uncertainty.statistics < 0.02);
    CHECK(length(mean(series.torque)) < 0.01);
}

TEST_CASE("a cylinder's section sheds at the right frequency", "[flow]") {
    FlowCase c = unit_case(100, 12, 60, 30);
    c.section = true;
    const Surface cylinder = test::cylinder(0.5, 2, 96);
    const FlowSeries series = solve(cylinder, c);
    const Coefficients k(series);
    CHECK(k.total.x == Approx(1.34).epsilon(0.08));
    CHECK(k.total.z == 0);
    int rises = 0;
    double first = 0, last = 0;
    for (std::uint32_t i = 1; i < series.samples; ++i) {
        const std::size_t now = std::size_t{3} * i + 1, before = now - 3;
        if (series.pressure[before] < 0 && series.pressure[now] >= 0) {
            (rises == 0 ? first : last) = i * series.interval;
            ++rises;
        }
    }
    REQUIRE(rises > 2);
    CHECK((rises - 1) / (last - first) == Approx(0.1645).epsilon(0.05));
}

TEST_CASE("the result does not depend on the number of threads", "[flow]") {
    const Surface body = test::rotated(test::box({0.5, 1, 1.5}), {1, 2, 3}, 0.4);
    Regions regions;
    regions.count = 12;
    for (std::uint32_t t = 0; t < 12; ++t) regions.region.push_back(t);
    FlowCase c = unit_case(5000, 7, 2, 2);
    c.threads = 1;
    const FlowSeries one = solve_flow(body, regions, c, nullptr);
    for (const int threads : {2, 3}) {
        c.threads = threads;
        const FlowSeries many = solve_flow(body, regions, c, nullptr);
        CHECK(same_bits(one.pressure, many.pressure));
        CHECK(same_bits(one.friction, many.friction));
        CHECK(same_bits(one.torque, many.torque));
        CHECK(one.uncertainty.statistics == many.uncertainty.statistics);
    }
}

TEST_CASE("regions sum to the whole body", "[flow]") {
    const Surface body = test::box({1, 1, 1});
    Regions regions;
    regions.count = 6;
    for (std::uint32_t t = 0; t < 12; ++t) regions.region.push_back(t / 2);
    const FlowCase c = unit_case(1000, 6, 3, 2);
    const Coefficients whole(solve(body, c)), parts(solve_flow(body, regions, c, nullptr));
    for (int i = 0; i < 3; ++i) CHECK(parts.total[i] == Approx(whole.total[i]).epsilon(1e-4).margin(1e-5));
}

TEST_CASE("the force turns with the body and the stream", "[flow]") {
    const Surface body = test::box({0.4, 1, 1});
    FlowCase c = unit_case(300, 9, 5, 3);
    const Coefficients straight(solve(body, c));
    const Vec3d axis{1, -2, 0.5};
    c.direction = test::rotated({1, 0, 0}, axis, 0.7);
    const Coefficients turned(solve(test::rotated(body, axis, 0.7), c));
    const double along = dot(turned.total, c.direction);
    CHECK(along == Approx(straight.total.x).epsilon(0.05));
    CHECK(length(turned.total - c.direction * along) < 0.05 * along);
}

TEST_CASE("a symmetric box face-on has no lift, and a torque that follows its place", "[flow]") {
    const FlowCase c = unit_case(200, 8, 6, 2);
    const Coefficients middle(solve(test::box({1, 1, 1}), c));
    CHECK(middle.total.x > 0.8);
    CHECK(std::abs(middle.total.y) < 0.02 * middle.total.x);
    CHECK(std::abs(middle.total.z) < 0.02 * middle.total.x);
    const FlowSeries away = solve(test::moved(test::box({1, 1, 1}), {0, 2, 0}), c);
    CHECK(mean(away.torque).z == Approx(-2 * (mean(away.pressure).x + mean(away.friction).x)).epsilon(0.02));
}

TEST_CASE("a sheet thinner than a cell stops the water", "[flow]") {
    const FlowCase c = unit_case(1e4, 8, 6, 6);
    const Surface sheet = test::box({0.01, 1, 1});
    CHECK(mentions(plan_flow(sheet, c).warning, "thick"));
    CHECK(Coefficients(solve(sheet, c)).total.x == Approx(1.17).epsilon(0.2));
    // Oblique, so that it passes between the nodes at every distance.
    const Coefficients oblique(solve(test::rotated(sheet, {0, 0, 1}, 0.5), c));
    CHECK(oblique.total.x > 0.6);
    CHECK(oblique.total.y / oblique.total.x == Approx(std::tan(0.5)).epsilon(0.15));
}

TEST_CASE("the plan says what a run takes", "[flow]") {
    FlowCase c;
    c.reference_length = 0;
    const FlowPlan plan = plan_flow(test::box({1, 1, 2}), c);
    CHECK(plan.projected_area == Approx(2).epsilon(0.01));
    CHECK(plan.reference_length == Approx(std::sqrt(2.0)).epsilon(0.01));
    CHECK(plan.cell == Approx(plan.reference_length / c.resolution));
    CHECK(plan.reynolds == Approx(c.speed * plan.reference_length / c.viscosity));
    CHECK(plan.reynolds_solved < plan.reynolds);
    CHECK(mentions(plan.warning, "Reynolds"));
    CHECK(plan.blockage > 0.001);
    CHECK(plan.blockage < 0.01);
    CHECK(plan.blocks.size() >= 4);
    CHECK(plan.blocks.front().cell == plan.cell);
    for (std::size_t l = 1; l < plan.blocks.size(); ++l) {
        const FlowBlock &fine = plan.blocks[l - 1], &coarse = plan.blocks[l];
        CHECK(coarse.cell == Approx(2 * fine.cell));
        for (int axis = 0; axis < 3; ++axis) {
            CHECK(coarse.low[axis] < fine.low[axis] - coarse.cell);
            CHECK(coarse.high[axis] > fine.high[axis] + coarse.cell);
        }
    }
    CHECK(plan.bytes > plan.cells * 19 * 4 * 2);
    CHECK(static_cast<double>(plan.steps) * plan.time_step ==
          Approx((c.start_up + c.duration) * plan.reference_length / c.speed).epsilon(0.02));
}

TEST_CASE("what is wrong with a case is named", "[flow]") {
    const Surface body = test::box({1, 1, 1});
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const FlowCase good = unit_case(100, 8, 3, 3);
    REQUIRE(error_of(body, good).empty());
    const auto error_with = [&](auto change) {
        FlowCase c = good;
        change(c);
        return error_of(body, c);
    };
    CHECK(mentions(error_with([&](FlowCase& c) { c.direction = {1, 1, 0}; }), "direction"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.direction.y = nan; }), "direction"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.speed = 0; }), "speed"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.viscosity = -1; }), "viscosity"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.density = infinity; }), "density"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.resolution = 3; }), "resolution"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.resolution = 1e9; }), "resolution"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.reference_length = -2; }), "reference_length"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.start_up = nan; }), "start_up"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.duration = 1e9; }), "duration"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.threads = -1; }), "threads"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.memory_limit = 1000; }), "memory_limit"));
    CHECK(mentions(error_with([&](FlowCase& c) {
                       c.reference_length = 1e-5;
                       c.viscosity = 1e-7;
                   }),
                   "reference_length"));
    CHECK(mentions(error_with([&](FlowCase& c) {
                       c.resolution = 500;
                       c.memory_limit = std::uint64_t{8} << 30;
                   }),
                   "memory_limit"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.confidence = 2; }), "confidence"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.seconds = -1; }), "seconds"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.turn = nan; }), "turn"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.slab = 2; }), "slab"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.spin = {0, 0, infinity}; }), "spin"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.spin = {0, 0, 1}; }), "revolution"));
    CHECK(mentions(error_with([&](FlowCase& c) {
                       c.section = true;
                       c.turn = 30;
                   }),
                   "turn"));
    CHECK(mentions(error_with([&](FlowCase& c) {
                       c.section = true;
                       c.section_normal = {1, 0, 0};
                   }),
                   "section_normal"));
    CHECK(mentions(error_with([&](FlowCase& c) {
                       c.section = true;
                       c.section_origin = {0, 0, 5};
                   }),
                   "section_origin"));
    CHECK(mentions(error_with([&](FlowCase& c) {
                       c.section = true;
                       c.section_span = 0;
                   }),
                   "section_span"));
    CHECK(mentions(error_with([&](FlowCase& c) { c.viscosity = 1e5; }), "Reynolds"));

    Surface broken = body;
    broken.triangles[3][1] = 99;
    CHECK_FALSE(error_of(broken, good).empty());
    broken = body;
    broken.vertices[0].x = nan;
    CHECK_FALSE(error_of(broken, good).empty());
    CHECK_FALSE(error_of(Surface{}, good).empty());

    Regions regions = one_region(body);
    regions.region[5] = 1;
    CHECK_THROWS_AS(solve_flow(body, regions, good, nullptr), BakeError);
    regions.region.pop_back();
    CHECK_THROWS_AS(solve_flow(body, regions, good, nullptr), BakeError);
}

TEST_CASE("progress is told, and can stop a run", "[flow]") {
    const Surface body = test::box({1, 1, 1});
    const FlowCase c = unit_case(100, 6, 1, 1);
    double last = 0;
    bool started = false, recorded = false;
    const auto watch = [&](const FlowState& state) {
        CHECK(state.share >= last);
        last = state.share;
        (state.recording ? recorded : started) = true;
        if (state.recording) CHECK(state.drag_coefficient > 0.5);
        return true;
    };
    const FlowSeries whole = solve_flow(body, one_region(body), c, watch);
    CHECK(last <= 1);
    CHECK(whole.ending == FlowEnding::duration);
    const auto stop = [](const FlowState&) { return false; };
    CHECK_THROWS_AS(solve_flow(body, one_region(body), c, stop), FlowCancelled);
}

TEST_CASE("a run on half the resolution tells the error of the grid", "[flow]") {
    const Surface sphere = test::icosphere(0.5, 4);
    FlowCase c = unit_case(100, 16, 8, 4);
    c.grid_error = true;
    const FlowSeries series = solve(sphere, c);
    const double drag = mean(series.pressure).x + mean(series.friction).x;
    CHECK(Coefficients(series).total.x == Approx(1.09).epsilon(0.05));
    CHECK(series.coarse_drag > drag);
    CHECK(series.uncertainty.grid > 0.01);
    CHECK(series.uncertainty.grid < 0.1);
    CHECK(series.uncertainty.total() >= series.uncertainty.grid);
    // It starts from there, so that it is as far as a run of its own is after twice the time.
    CHECK(series.uncertainty.statistics < 0.01);
    c.resolution = 6;  // too few to halve
    CHECK(solve(sphere, c).uncertainty.grid < 0);
}

TEST_CASE("a layer that is thinner than cells counts on a sphere and not on a cube", "[flow]") {
    FlowCase c = unit_case(1e4, 12, 2, 2);
    c.grid_error = true;
    const auto grid = [&](const Surface& body) { return solve(body, c).uncertainty.grid; };
    CHECK(grid(test::icosphere(0.5, 4)) > 0.15);
    const FlowSeries cube = solve(test::box({1, 1, 1}), c);
    const double fine = mean(cube.pressure).x + mean(cube.friction).x;
    CHECK(cube.uncertainty.grid == Approx(0.5 * std::abs(1 - cube.coarse_drag / fine)).margin(1e-3));
}

// Dennis, Singh and Ingham 1980, J. Fluid Mech. 101: 2 T / (rho w^2 a^5) = 6.45 Re^-1/2 + 32.1 / Re.
TEST_CASE("a sphere that spins in still water feels the torque of the literature", "[flow]") {
    FlowCase c = unit_case(200, 14, 18, 2);
    c.speed = 0;
    c.spin = {0, 0, 2};  // the equator at 1 m/s
    c.viscosity = 2 * 0.25 / 200;
    const FlowSeries series = solve(test::icosphere(0.5, 4), c);
    const double torque = -mean(series.torque).z * 2 / (4 * std::pow(0.5, 5));
    CHECK(torque == Approx(6.45 / std::sqrt(200.0) + 32.1 / 200).epsilon(0.08));
    CHECK(length(mean(series.pressure)) < 0.02 * torque);
    CHECK(std::abs(mean(series.torque).x) < 0.02 * torque);
}

TEST_CASE("a slab of a section has the force of its span", "[flow]") {
    FlowCase c = unit_case(60, 10, 6, 3);
    c.section = true;
    const Surface cylinder = test::cylinder(0.5, 2, 96);
    const Coefficients flat(solve(cylinder, c));
    c.slab = 1.5;
    const FlowPlan plan = plan_flow(cylinder, c);
    CHECK(plan.blocks.front().high.z - plan.blocks.front().low.z > 1);
    CHECK(mentions(plan.warning, "slab"));  // 1.5 is no whole number of coarsest cells
    // At this Reynolds number nothing happens along the span.
    CHECK(Coefficients(solve(cylinder, c)).total.x == Approx(flat.total.x).epsilon(0.01));
}

TEST_CASE("the layers of a slab differ once its wake is three-dimensional", "[flow]") {
    FlowCase c = unit_case(1e4, 8, 20, 4);
    c.section = true;
    c.slab = 4;
    const FlowSeries series = solve(test::box({1, 1, 2}), c);
    double across = 0, along = 0;
    for (std::size_t i = 0; i < series.pressure.size(); i += 3) {
        across = std::max(across, std::abs(static_cast<double>(series.pressure[i + 1])));
        along = std::max(along, std::abs(static_cast<double>(series.friction[i + 2])));
    }
    CHECK(across > 0);
    CHECK(along > 1e-3 * across);
}

TEST_CASE("a slab's finest cells hold the layers that leave its edges", "[flow]") {
    FlowCase c = unit_case(1e4, 36, 10, 10);
    c.section = true;
    c.slab = 4;
    const Surface body = test::box({5, 1, 2});
    for (const double cells : {24.0, 36.0, 48.0}) {
        INFO(cells << " cells");
        c.resolution = cells;
        const FlowPlan plan = plan_flow(body, c);
        const FlowBlock &finest = plan.blocks.front(), &wake = plan.blocks[cells > 24 ? 1 : 0];
        const double border = 2 * wake.cell;
        CHECK(finest.low.x <= -2.5 - 0.3 + border);
        CHECK(finest.high.x >= 2.5 + 1.5 - border);
        CHECK(finest.low.y <= -0.5 - 0.6 + border);
        CHECK(finest.high.y >= 0.5 + 0.6 - border);
        CHECK(wake.high.x >= 2.5 + 10 - border);
        CHECK(wake.cell <= 1 / 12.0);
    }
}

TEST_CASE("a run ends when it knows enough, or when its time is up", "[flow]") {
    const Surface body = test::box({1, 1, 1});
    FlowCase c = unit_case(100, 8, 6, 200);
    c.confidence = 0.02;
    const FlowSeries sure = solve(body, c);
    CHECK(sure.ending == FlowEnding::confidence);
    CHECK(sure.uncertainty.statistics <= 0.02);
    CHECK(sure.samples * sure.interval < 100);
    CHECK(sure.torque.size() == std::size_t{3} * sure.samples);

    c.confidence = 0;
    c.start_up = 0.5;  // over soon on a slow machine too
    c.duration = 1e4;
    c.seconds = 1;
    const FlowSeries late = solve(body, c);
    CHECK(late.ending == FlowEnding::seconds);
    CHECK(late.seconds < 30);
    CHECK(late.samples > 0);

    c.seconds = 0;
    const auto stop = [](const FlowState& state) { return !state.recording; };
    const FlowSeries cancelled = solve_flow(body, one_region(body), c, stop);
    CHECK(cancelled.ending == FlowEnding::cancelled);
    CHECK(cancelled.samples > 0);
}

TEST_CASE("a run that ends before it records on all cells is the one on half of them", "[flow]") {
    const Surface body = test::box({1, 1, 1});
    FlowCase c = unit_case(100, 12, 30, 2);
    c.grid_error = true;
    const auto stop = [](const FlowState& state) { return state.coarse || state.recording; };
    const FlowSeries half = solve_flow(body, one_region(body), c, stop);
    CHECK(half.ending == FlowEnding::cancelled);
    CHECK(half.half);
    REQUIRE(half.samples > 0);
    CHECK(half.uncertainty.grid < 0);
    FlowCase coarse = c;
    coarse.grid_error = false;
    coarse.resolution = 6;
    const FlowSeries alone = solve(body, coarse);
    CHECK(half.steps == alone.steps);
    CHECK(half.pressure == alone.pressure);
}

TEST_CASE("pictures show the stream ahead, and the wake", "[flow]") {
    FlowCase c = unit_case(100, 8, 6, 3);
    c.pictures = true;
    const FlowSeries series = solve(test::box({1, 1, 1}), c);
    REQUIRE(series.slices.size() == 2);
    for (const FlowSlice& slice : series.slices) {
        REQUIRE(slice.speed.size() == std::size_t{slice.columns} * slice.rows);
        const auto at = [&](double x, double across) {
            const auto column = static_cast<std::size_t>((x - slice.low.x) / slice.spacing);
            const auto row = static_cast<std::size_t>((across - slice.low[3 - slice.normal]) / slice.spacing);
            return row * slice.columns + column;
        };
        CHECK(std::isnan(slice.speed[at(0, 0)]));
        CHECK(slice.speed[at(0.9, 0)] < 0.5f);
        CHECK(slice.speed[at(0, 1.2)] > 1.0f);
        CHECK(slice.pressure[at(-0.7, 0)] > 0.6f);
        CHECK(slice.pressure[at(0.7, 0)] < 0.0f);
    }
}

TEST_CASE("the lattice turned about the stream changes little", "[flow]") {
    FlowCase c = unit_case(100, 12, 8, 3);
    const double straight = Coefficients(solve(test::box({1, 1, 1}), c)).total.x;
    c.turn = 30;
    CHECK(Coefficients(solve(test::box({1, 1, 1}), c)).total.x == Approx(straight).epsilon(0.03));
}
