// The pose from quantised lengths and the twist from poses, against the motion that made them.
#include <algorithm>
#include <cmath>

#include "tests/device/spidar_g.h"

using namespace frm;
using namespace frm::test;

namespace {

/// A circle at 1 m/s somewhere in the workspace while the grip swings about a fixed axis.
struct Motion {
    Vec3d centre, a, b, axis;
    double radius, swing;

    GripPose at(double t) const {
        const double phase = t / radius, angle = swing * std::sin(5 * t);
        const double s = std::sin(angle / 2);
        return {centre + a * (radius * std::cos(phase)) + b * (radius * std::sin(phase)),
                {axis.x * s, axis.y * s, axis.z * s, std::cos(angle / 2)}};
    }
    GripTwist twist(double t) const {
        const double phase = t / radius;
        return {b * std::cos(phase) - a * std::sin(phase), axis * (swing * 5 * std::cos(5 * t))};
    }
};

Motion random_motion(Random& random, double reach) {
    Motion m;
    m.a = random.direction();
    m.b = random.direction();
    m.b -= m.a * dot(m.a, m.b);
    m.b = m.b / length(m.b);
    m.axis = random.direction();
    m.radius = random(0.4, 0.9) * reach;
    m.centre = random.direction() * (reach - m.radius);
    m.swing = random(0, 45) * degree;
    return m;
}

Lengths measured(const Configuration& c, const GripPose& pose) {
    StringRows rows;
    REQUIRE(string_rows(c.geometry, pose, rows));
    Lengths out;
    for (std::size_t i = 0; i < out.size(); ++i) {
        const double pulse = std::fabs(c.motors[i].metres_per_pulse);
        out[i] = (std::floor(rows.length[i] / pulse) + 0.5) * pulse;
    }
    return out;
}

}  // namespace

TEST_CASE("a pose at 1 m/s and 1 kHz from encoders is right to 0.05 mm and 0.2 degrees", "[spidar_g]") {
    const Configuration c = load_configuration(nullptr);
    Random random;
    double worst_position = 0, worst_angle = 0;
    int most_iterations = 0;
    for (int run = 0; run < 100; ++run) {
        const Motion motion = random_motion(random, 0.04);
        GripPose pose = motion.at(0);
        for (int k = 1; k <= 300; ++k) {
            const GripPose truth = motion.at(k * 1e-3);
            const PoseFit fit = fit_pose(c.geometry, measured(c, truth), pose);
            REQUIRE(fit.converged);
            pose = fit.pose;
            worst_position = std::max(worst_position, length(pose.position - truth.position));
            worst_angle = std::max(worst_angle, length(rotation_between(truth.rotation, pose.rotation)));
            most_iterations = std::max(most_iterations, fit.iterations);
        }
    }
    INFO(worst_position << " m, " << worst_angle / degree << " degrees, " << most_iterations << " iterations");
    CHECK(worst_position < 0.05e-3);
    CHECK(worst_angle < 0.2 * degree);
    CHECK(most_iterations < pose_iterations);
}

TEST_CASE("the twist is that of half a window ago", "[spidar_g]") {
    const Configuration c = load_configuration(nullptr);
    Random random;
    double squares = 0, turning = 0, undelayed = 0;
    int n = 0;
    for (int run = 0; run < 40; ++run) {
        const Motion motion = random_motion(random, 0.04);
        GripPose pose = motion.at(0);
        VelocityFilter filter(c.velocity_window);
        const double delay = filter.delay_cycles() * 1e-3;
        CHECK(delay == 3.5e-3);
        for (int k = 0; k < 200; ++k) {
            pose = fit_pose(c.geometry, measured(c, motion.at(k * 1e-3)), pose).pose;
            const GripTwist twist = filter.add(pose, 1e-3);
            if (k < 10) continue;
            const GripTwist then = motion.twist(k * 1e-3 - delay), now = motion.twist(k * 1e-3);
            squares += dot(twist.linear - then.linear, twist.linear - then.linear);
            undelayed += dot(twist.linear - now.linear, twist.linear - now.linear);
            turning += dot(twist.angular - then.angular, twist.angular - then.angular);
            ++n;
        }
    }
    // A difference of two quantised poses alone is off by some 10 mm/s and 0.6 rad/s.
    CHECK(std::sqrt(squares / n) < 0.008);
    CHECK(std::sqrt(turning / n) < 0.15);
    CHECK(std::sqrt(undelayed / n) > 0.05);
}

TEST_CASE("a velocity filter is exact for uneven cycles and begins at rest", "[spidar_g]") {
    VelocityFilter filter(8);
    Random random;
    GripPose pose;
    CHECK(length(filter.add(pose, 1).linear) == 0);
    for (int k = 0; k < 30; ++k) {
        const double dt = random(0.5e-3, 2e-3);
        pose.position += Vec3d(0.3, -0.2, 0.1) * dt;
        const GripTwist twist = filter.add(pose, dt);
        CHECK(length(twist.linear - Vec3d(0.3, -0.2, 0.1)) < 1e-12);
    }
    filter.reset();
    CHECK(length(filter.add(pose, 1e-3).linear) == 0);
}

TEST_CASE("lengths that no pose has are said to be so", "[spidar_g]") {
    const Configuration c = load_configuration(nullptr);
    const Lengths good = measured(c, {});
    for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300}) {
        Lengths lengths = good;
        lengths[3] = bad;
        const PoseFit fit = fit_pose(c.geometry, lengths, {});
        CHECK_FALSE(fit.converged);
        CHECK(length(fit.pose.position) == 0);
        CHECK(fit.iterations <= pose_iterations);
    }
    GripPose start;
    start.position.x = std::nan("");
    CHECK_FALSE(fit_pose(c.geometry, good, start).converged);
    // One wrong length leaves a residual that names it, or its partner that spans the same pose.
    Lengths lengths = good;
    lengths[3] += 0.01;
    const PoseFit fit = fit_pose(c.geometry, lengths, {});
    REQUIRE(fit.converged);
    CHECK(fit.residual_rms > 1e-3);
    double largest = 0;
    for (const double r : fit.normalised_residual) largest = std::max(largest, std::fabs(r));
    CHECK(std::fabs(fit.normalised_residual[3]) > 0.95 * largest);
}

TEST_CASE("a small turn and the way between two rotations are each other's inverse", "[spidar_g]") {
    Random random;
    for (int k = 0; k < 1000; ++k) {
        const Quat<double> q = turned(turned({}, random.vector(0.6)), random.vector(0.6));
        const Vec3d v = random.direction() * random(0, 0.02);
        CHECK(length(rotation_between(q, turned(q, v)) - v) < 1e-6);
        const double angle = random(0, 0.9);
        const Vec3d axis = random.direction();
        const double s = std::sin(angle / 2);
        const Quat<double> step{axis.x * s, axis.y * s, axis.z * s, std::cos(angle / 2)};
        CHECK(length(rotation_between(q, step * q) - axis * angle) < 3e-4);
    }
}
