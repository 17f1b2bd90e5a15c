// How much of a body's drag a grip is made to feel by a sampled loop.
#include <random>

#include "device/servo/drag_limit.h"
#include "tests/support/catch.h"

using namespace frm;
using device::DragLimit;
using device::Matrix6;

namespace {

constexpr double dt = 0.002;
constexpr DragLimit::Grip ball{1 / 0.1, 1 / 5e-5};

Matrix6 diagonal(double linear, double angular) {
    Matrix6 d{};
    for (std::size_t i = 0; i < 6; ++i) d[7 * i] = i < 3 ? linear : angular;
    return d;
}

bool same(const Wrench& a, const Wrench& b) {
    return a.force.x == b.force.x && a.force.y == b.force.y && a.force.z == b.force.z && a.torque.x == b.torque.x &&
           a.torque.y == b.torque.y && a.torque.z == b.torque.z;
}

/// Power that a damper takes.
double power(const Matrix6& d, const Vec3d& v, const Vec3d& w) {
    const double u[6] = {v.x, v.y, v.z, w.x, w.y, w.z};
    double out = 0;
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) out += u[i] * d[6 * i + j] * u[j];
    return out;
}

/// Positive semi-definite, as what drag gives.
Matrix6 some_damping(std::mt19937& random, double strength) {
    std::uniform_real_distribution<double> part(-1, 1);
    Matrix6 d{};
    for (int k = 0; k < 6; ++k) {
        double u[6];
        for (double& x : u) x = part(random);
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t j = 0; j < 6; ++j) d[6 * i + j] += strength * u[i] * u[j];
    }
    return d;
}

}  // namespace

TEST_CASE("drag limit: the damping about another point takes the same power", "[drag_limit]") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> part(-1, 1);
    for (int k = 0; k < 50; ++k) {
        const Matrix6 d = some_damping(random, 3);
        const Vec3d arm(part(random), part(random), part(random)), v(part(random), part(random), part(random)),
            w(part(random), part(random), part(random));
        // The old point goes along with the new one and turns about it.
        CHECK(std::fabs(power(device::about(arm, d), v, w) - power(d, v + cross(w, arm), w)) < 1e-12 * 100);
    }
}

TEST_CASE("drag limit: what a grip bears is left to the bit", "[drag_limit]") {
    DragLimit limit;
    const Wrench a{{1.3f, -2, 0.7f}, {0.01f, 0.02f, -0.03f}}, b{{-7, 3, 1}, {0.1f, 0, 0}};
    // M / (4 T) is 12.5 N s/m and 6.25e-3 N m s/rad; of all six together.
    const Matrix6 little = diagonal(2, 1e-3);
    for (const Wrench& w : {a, b, a}) {
        CHECK(same(limit.limit(w, little, dt, ball), w));
        CHECK(limit.excess() < 1);
    }
    // The first wrench is no change.
    DragLimit other;
    CHECK(same(other.limit(b, diagonal(100, 1), dt, ball), b));
}

TEST_CASE("drag limit: a change is felt weakly at once and wholly later", "[drag_limit]") {
    DragLimit limit;
    const Matrix6 d = diagonal(125, 1e-4);  // ten times what is borne along, nothing to speak of about
    const Wrench none{}, all{{0, 10, 0}, {0.2f, 0, 0}};
    limit.limit(none, d, dt, ball);
    Wrench felt = limit.limit(all, d, dt, ball);
    CHECK(std::fabs(limit.excess() - 10) < 1e-9);
    // A tenth, and 1 / 81 of the rest.
    CHECK(std::fabs(static_cast<double>(felt.force.y) - (10.0 / 81 + (10 - 10.0 / 81) / 10)) < 1e-4);
    CHECK(std::fabs(felt.torque.x - 0.2f) < 1e-6f);
    double before = static_cast<double>(felt.force.y);
    for (int k = 0; k < 80; ++k) {  // one settling time
        felt = limit.limit(all, d, dt, ball);
        CHECK(static_cast<double>(felt.force.y) > before);
        before = static_cast<double>(felt.force.y);
    }
    CHECK(std::fabs(before - (10 - 9 * std::exp(-1.0))) < 0.1);
    for (int k = 0; k < 1000; ++k) felt = limit.limit(all, d, dt, ball);
    CHECK(std::fabs(felt.force.y - 10) < 1e-3f);
    // Water that is gone takes its force with it.
    CHECK(same(limit.limit(none, diagonal(0, 0), dt, ball), none));
}

TEST_CASE("drag limit: what the host scales to nothing is left alone", "[drag_limit]") {
    DragLimit limit;
    const Matrix6 d = diagonal(1000, 1);
    limit.limit({}, d, dt, {1 / 0.1, 0});
    const Wrench all{{0, 10, 0}, {0.2f, 0.3f, 0}}, felt = limit.limit(all, d, dt, {1 / 0.1, 0});
    CHECK(felt.torque.x == 0.2f);
    CHECK(felt.torque.y == 0.3f);
    CHECK(felt.force.y < 1);
}

// A free grip without any damping of its own, a damper that is sampled, held, and displayed a cycle late, a metre away.
TEST_CASE("drag limit: a damper of any strength stops a light grip, however far away", "[drag_limit]") {
    std::mt19937 random(3);
    const double mass = 0.1, inertia = 1e-4;
    int swung = 0;
    for (const double strength : {0.1, 3.0, 60.0, 1000.0})
        for (const double reach : {0.0, 0.1, 1.0})
            for (const bool limited : {false, true}) {
                const Matrix6 d = device::about({0.1 * reach, 0, -reach}, some_damping(random, strength));
                DragLimit limit;
                double u[6] = {0.3, -0.2, 0.1, 1, 0.5, -1}, command[6] = {}, shown[6] = {};
                const auto energy = [&] {
                    double e = 0;
                    for (int i = 0; i < 6; ++i) e += u[i] * u[i] * (i < 3 ? mass : inertia) / 2;
                    return e;
                };
                const double start = energy();
                if (limited) limit.limit({}, d, dt, {1 / mass, 1 / inertia});  // it moves off now
                double most = 0;
                for (int k = 0; k < 5000 && most < 1e6 * start; ++k) {
                    Wrench w;
                    for (int i = 0; i < 6; ++i) {
                        double sum = 0;
                        for (int j = 0; j < 6; ++j) sum -= d[static_cast<std::size_t>(6 * i + j)] * u[j];
                        (i < 3 ? w.force : w.torque)[i % 3] = static_cast<float>(sum);
                    }
                    if (limited) w = limit.limit(w, d, dt, {1 / mass, 1 / inertia});
                    for (int i = 0; i < 6; ++i) {
                        shown[i] = command[i];
                        command[i] = static_cast<double>((i < 3 ? w.force : w.torque)[i % 3]);
                        u[i] += shown[i] * dt / (i < 3 ? mass : inertia);
                    }
                    const double e = energy();
                    if (k > 50 || !(e < 1e12)) most = e < 1e12 ? std::max(most, e) : 1e12;
                }
                INFO("strength " << strength << ", reach " << reach << ", limited " << limited);
                swung += !limited && most > 100 * start;
                if (limited) {
                    CHECK(most < 1.5 * start);
                    CHECK(energy() < start);
                }
            }
    CHECK(swung >= 6);
}
