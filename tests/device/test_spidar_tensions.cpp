// Tensions against a second solver of the same problem: projected gradient, in many small steps.
#include <algorithm>
#include <cmath>

#include "tests/device/spidar_g.h"

using namespace frm;
using namespace frm::test;

namespace {

/// Distance of two wrenches in newtons, torques over the lever.
double distance(const GripWrench& a, const GripWrench& b, double lever) {
    const Vec3d f = a.force - b.force, m = (a.torque - b.torque) / lever;
    return std::sqrt(dot(f, f) + dot(m, m));
}

double strength(const GripWrench& a, double lever) { return distance(a, {}, lever); }

/// The least distance that tensions within the limits have from `wrench`: Nesterov's accelerated projected gradient.
double least_distance(const StringRows& rows, const TensionLimits& limits, const GripWrench& wrench, double lever) {
    Tensions t = limits.low, y = t;
    double momentum = 1;
    const double w[6] = {wrench.force.x,          wrench.force.y,          wrench.force.z,
                         wrench.torque.x / lever, wrench.torque.y / lever, wrench.torque.z / lever};
    for (int step = 0; step < 20000; ++step) {
        double error[6];
        for (int k = 0; k < 6; ++k) {
            error[k] = -w[k];
            for (std::size_t i = 0; i < y.size(); ++i) error[k] += rows.row[i][k] * y[i];
        }
        const Tensions before = t;
        for (std::size_t i = 0; i < t.size(); ++i) {
            double slope = 0;
            for (int k = 0; k < 6; ++k) slope += rows.row[i][k] * error[k];
            // 1/16: eight rows of length at most sqrt(2).
            t[i] = std::min(std::max(y[i] - slope / 16, limits.low[i]), limits.high[i]);
        }
        const double next = (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
        for (std::size_t i = 0; i < t.size(); ++i) y[i] = t[i] + (momentum - 1) / next * (t[i] - before[i]);
        momentum = next;
    }
    return distance(wrench_of(rows, t, lever), wrench, lever);
}

GripPose random_pose(Random& random) { return {random.direction() * random(0, 0.04), turned({}, random.vector(0.5))}; }

bool within(const Tensions& t, const TensionLimits& limits) {
    for (std::size_t i = 0; i < t.size(); ++i)
        if (!(t[i] >= limits.low[i] && t[i] <= limits.high[i])) return false;
    return true;
}

}  // namespace

TEST_CASE("every wrench that can be reached is displayed to 1 %", "[spidar_g]") {
    const Configuration c = load_configuration(nullptr);
    const double lever = c.geometry.lever;
    Random random;
    TensionSolver warm(c.limits);
    double worst = 0;
    int most = 0;
    for (int k = 0; k < 20000; ++k) {
        StringRows rows;
        REQUIRE(string_rows(c.geometry, random_pose(random), rows));
        // Of tensions within the limits, so it can be reached; some of them at a limit.
        Tensions t;
        for (std::size_t i = 0; i < t.size(); ++i) {
            const double x = random(-0.3, 1.3);
            t[i] = c.limits.low[i] + std::min(std::max(x, 0.0), 1.0) * (c.limits.high[i] - c.limits.low[i]);
        }
        const GripWrench wrench = wrench_of(rows, t, lever);
        TensionSolver cold(c.limits);
        TensionSolver& solver = k % 2 ? warm : cold;
        const TensionResult result = solver.solve(rows, wrench, lever);
        REQUIRE(result.optimal);
        REQUIRE(within(result.tensions, c.limits));
        most = std::max(most, result.iterations);
        worst =
            std::max(worst, distance(wrench_of(rows, result.tensions, lever), wrench, lever) / strength(wrench, lever));
    }
    INFO(worst << " of the wrench, " << most << " iterations");
    CHECK(worst < 0.01);
    CHECK(most < tension_iterations);
}

TEST_CASE("what was lost in older drivers is displayed: 5 N and 0.1 N m", "[spidar_g]") {
    const Configuration c = load_configuration(nullptr);
    StringRows rows;
    REQUIRE(string_rows(c.geometry, {}, rows));
    Random random;
    TensionSolver solver(c.limits);
    for (int k = 0; k < 100; ++k) {
        const GripWrench force{random.direction() * 5.0, {}}, torque{{}, random.direction() * 0.1};
        const GripWrench f = wrench_of(rows, solver.solve(rows, force, c.geometry.lever).tensions, c.geometry.lever);
        CHECK(length(f.force - force.force) < 0.05);
        const GripWrench m = wrench_of(rows, solver.solve(rows, torque, c.geometry.lever).tensions, c.geometry.lever);
        CHECK(length(m.torque - torque.torque) < 0.001);
    }
}

TEST_CASE("a wrench out of reach becomes the nearest one", "[spidar_g]") {
    const Configuration c = load_configuration(nullptr);
    const double lever = c.geometry.lever;
    Random random;
    TensionSolver solver(c.limits);
    int out_of_reach = 0;
    for (int k = 0; k < 60; ++k) {
        StringRows rows;
        REQUIRE(string_rows(c.geometry, random_pose(random), rows));
        const GripWrench wrench{random.direction() * random(0, 60), random.direction() * random(0, 1.5)};
        const TensionResult result = solver.solve(rows, wrench, lever);
        REQUIRE(result.optimal);
        REQUIRE(within(result.tensions, c.limits));
        const double mine = distance(wrench_of(rows, result.tensions, lever), wrench, lever);
        const double least = least_distance(rows, c.limits, wrench, lever);
        CHECK(mine < least + 1e-3 * strength(wrench, lever) + 1e-3);
        out_of_reach += least > 0.01 * strength(wrench, lever);
    }
    CHECK(out_of_reach > 20);
}

TEST_CASE("tensions stay within limits for wrenches that cannot be", "[spidar_g]") {
    const Configuration c = load_configuration(nullptr);
    StringRows rows;
    REQUIRE(string_rows(c.geometry, {}, rows));
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300, 1e11, -1e11}) {
        for (int k = 0; k < 6; ++k) {
            TensionSolver solver(c.limits);
            GripWrench wrench;
            (k < 3 ? wrench.force : wrench.torque)[k % 3] = bad;
            const TensionResult result = solver.solve(rows, wrench, c.geometry.lever);
            CHECK(within(result.tensions, c.limits));
            CHECK(result.iterations <= tension_iterations);
            // And what it keeps for the next call is of use.
            const GripWrench next{{1, 0, 0}, {}};
            const TensionResult after = solver.solve(rows, next, c.geometry.lever);
            CHECK(after.optimal);
            CHECK(distance(wrench_of(rows, after.tensions, c.geometry.lever), next, c.geometry.lever) < 0.01);
        }
    }
    // Rows that no strings have.
    for (auto& row : rows.row) row[2] = std::nan("");
    TensionSolver solver(c.limits);
    CHECK(solver.solve(rows, {{1, 0, 0}, {}}, c.geometry.lever).tensions == c.limits.low);
}

TEST_CASE("tensions change smoothly with the wrench", "[spidar_g]") {
    const Configuration c = load_configuration(nullptr);
    StringRows rows;
    REQUIRE(string_rows(c.geometry, {}, rows));
    TensionSolver solver(c.limits);
    Tensions last{};
    double largest = 0;
    for (int k = 0; k < 4000; ++k) {
        const double phase = k * 1e-3;
        const GripWrench wrench{{12 * std::cos(phase), 9 * std::sin(2 * phase), 3}, {0.1 * std::sin(phase), 0, 0.05}};
        const Tensions t = solver.solve(rows, wrench, c.geometry.lever).tensions;
        for (std::size_t i = 0; k > 0 && i < t.size(); ++i) largest = std::max(largest, std::fabs(t[i] - last[i]));
        last = t;
    }
    // The wrench moves by at most 0.022 N a step.
    CHECK(largest < 0.2);
}

TEST_CASE("the range of wrenches is that of the facets", "[spidar_g]") {
    const Configuration c = load_configuration(nullptr);
    StringRows rows;
    REQUIRE(string_rows(c.geometry, {}, rows));
    // Found by searching directions: at least 23.9 N and 0.419 N m; the facets' minimum is what no search goes below.
    CHECK(c.range.force > 23.0);
    CHECK(c.range.force <= 23.9);
    CHECK(std::fabs(c.range.torque - 0.419) < 0.001);
    Random random;
    TensionSolver solver(c.limits);
    double reached = 0;
    for (int k = 0; k < 3000; ++k) {
        const Vec3d direction = random.direction();
        const auto error = [&](double size) {
            const GripWrench w{direction * size, {}};
            return distance(wrench_of(rows, solver.solve(rows, w, c.geometry.lever).tensions, c.geometry.lever), w,
                            c.geometry.lever);
        };
        CHECK(error(c.range.force * 0.999) < 0.002);
        reached += error(c.range.force * 1.1) < 0.002;
    }
    CHECK(reached < 3000);  // some direction has no tenth more
}
