#include <cmath>
#include <limits>
#include <random>

#include "core/math/exponential.h"
#include "core/math/hash.h"
#include "core/math/logarithm.h"
#include "core/math/quat.h"
#include "tests/support/catch.h"

using namespace frm;

TEST_CASE("exponential agrees with the standard library", "[math]") {
    double worst = 0;
    for (float x = -79; x <= 0; x += 0.00137f) {
        const double exact = std::exp(static_cast<double>(x));
        worst = std::max(worst, std::fabs(static_cast<double>(exponential(x)) - exact) / exact);
    }
    CHECK(worst < 3e-7);
    CHECK(exponential(-81) == 0);
    CHECK(exponential(0) == 1);
    CHECK(exponential(3) == 1);
    CHECK(exponential(std::nanf("")) == 0);
}

TEST_CASE("logarithm agrees with the standard library", "[math]") {
    double worst = 0;
    for (float x = 1.2e-38f; x < 3e38f; x *= 1.00073f) {
        const double exact = std::log(static_cast<double>(x));
        worst = std::max(worst, std::fabs(static_cast<double>(logarithm(x)) - exact) / (1 + std::fabs(exact) / 2));
    }
    CHECK(worst < 2e-7);
    CHECK(logarithm(1) == 0);
    // It rises with its argument, but for a rounding: a blend between two speeds must not go backwards.
    float before = logarithm(0.01f), worst_fall = 0;
    for (float x = 0.01f; x < 100; x = std::nextafter(x * 1.000001f, 1e9f)) {
        worst_fall = std::max(worst_fall, before - logarithm(x));
        before = logarithm(x);
    }
    CHECK(worst_fall <= 4.8e-7f);  // a unit in the last place of 4.6, the logarithm of 100
    CHECK(logarithm(0) == logarithm(1.17549435e-38f));
    CHECK(logarithm(-1) == logarithm(0));
    CHECK(logarithm(std::nanf("")) == logarithm(0));
    CHECK(logarithm(INFINITY) == Approx(88.722839));
}

TEST_CASE("a rotation turns there and back", "[math]") {
    const Quat<double> q{0.5, -0.5, 0.5, 0.5};
    const Rotation<double> r(q);
    const Vec3d v(1, 2, 3);
    const Vec3d back = r.to_body(r.to_world(v));
    CHECK(back.x == Approx(1));
    CHECK(back.y == Approx(2));
    CHECK(back.z == Approx(3));
    const Rotation<double> z(Quat<double>{0, 0, std::sqrt(0.5), std::sqrt(0.5)});
    CHECK(z.to_world({1, 0, 0}).y == Approx(1));
}

TEST_CASE("the file hash is FNV-1a", "[math]") {
    // Values published with the function.
    CHECK(fnv1a("", 0) == 0xcbf29ce484222325ull);
    CHECK(fnv1a("a", 1) == 0xaf63dc4c8601ec8cull);
    CHECK(fnv1a("foobar", 6) == 0x85944171f73967e8ull);
}

TEST_CASE("the state hash sees every bit and the order", "[math]") {
    const auto hash = [](std::vector<float> values) {
        StateHash h;
        h.words(values.data(), values.size());
        return h.result();
    };
    const std::vector<float> values{1, 2, 3, 4, 5, 6, 7};
    for (std::size_t i = 0; i < values.size(); ++i) {
        std::vector<float> other = values;
        other[i] = std::nextafter(other[i], 100.0f);
        CHECK(hash(other) != hash(values));
    }
    CHECK(hash({1, 2}) != hash({2, 1}));
    CHECK(hash({0.0f}) != hash({-0.0f}));
}

TEST_CASE("numbers are hashed as words are, and all that are none as one", "[math]") {
    const auto words = [](const std::vector<float>& values) {
        StateHash h;
        h.words(values.data(), values.size());
        return h.result();
    };
    const auto numbers = [](const std::vector<float>& values) {
        StateHash h;
        h.numbers(values.data(), values.size());
        return h.result();
    };
    std::vector<float> values;
    for (int i = 0; i < 203; ++i) {
        values.push_back(0.37f * static_cast<float>(i - 90));
        CHECK(numbers(values) == words(values));
    }
    // infinity - infinity is the one on x86 and the other on ARM.
    const float none = std::numeric_limits<float>::quiet_NaN();
    for (const std::size_t at : {std::size_t{0}, std::size_t{100}, values.size() - 1}) {
        std::vector<float> one = values, other = values;
        one[at] = none;
        other[at] = std::copysign(none, -1.0f);
        CHECK(words(one) != words(other));
        CHECK(numbers(one) == numbers(other));
        CHECK(numbers(one) != numbers(values));
    }
}
