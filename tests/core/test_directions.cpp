#include <cmath>
#include <random>
#include <set>

#include "core/map/directions.h"
#include "tests/support/catch.h"

using namespace frm;

namespace {

Vec3f random_direction(std::mt19937& random) {
    std::normal_distribution<float> normal;
    return {normal(random), normal(random), normal(random)};
}

}  // namespace

TEST_CASE("each direction of a set is found exactly and has an index of its own", "[directions]") {
    for (const std::uint32_t n : {1u, 2u, 3u, 4u, 7u, 16u}) {
        const DirectionSet set(n);
        for (std::uint32_t i = 0; i < set.count(); ++i) {
            const Vec3d d = set.direction(i);
            REQUIRE(length(d) == Approx(1));
            const DirectionWeights w = set.interpolate(Vec3f(d));
            float own = 0;
            for (int k = 0; k < 3; ++k) {
                REQUIRE(w.index[k] < set.count());
                if (w.index[k] == i) own += w.weight[k];
            }
            REQUIRE(own == Approx(1).margin(2e-5));
        }
    }
    CHECK(DirectionSet(1).count() == 6);
    CHECK(DirectionSet(4).count() == 66);
}

TEST_CASE("weights are a partition of unity on three neighbours", "[directions]") {
    std::mt19937 random(1);
    for (const std::uint32_t n : {1u, 3u, 8u}) {
        const DirectionSet set(n);
        for (int i = 0; i < 20000; ++i) {
            const Vec3f d = random_direction(random);
            const DirectionWeights w = set.interpolate(d);
            const Vec3d e = Vec3d(d) / length(Vec3d(d));
            float sum = 0;
            for (int k = 0; k < 3; ++k) {
                REQUIRE(w.weight[k] >= 0);
                sum += w.weight[k];
                // No neighbour is further than the longest edge of the set: 90 degrees at n = 1.
                if (w.weight[k] > 0)
                    REQUIRE(dot(set.direction(w.index[k]), e) > std::cos(std::min(1.5708, 2.5 / n)) - 1e-6);
            }
            REQUIRE(sum == Approx(1).margin(1e-5));
        }
    }
}

TEST_CASE("interpolation is continuous, across faces too", "[directions]") {
    const DirectionSet set(5);
    std::mt19937 random(2);
    std::vector<float> value(set.count());
    for (float& v : value) v = std::uniform_real_distribution<float>(-1, 1)(random);
    const auto at = [&](const Vec3f& d) {
        const DirectionWeights w = set.interpolate(d);
        return w.weight[0] * value[w.index[0]] + w.weight[1] * value[w.index[1]] + w.weight[2] * value[w.index[2]];
    };
    for (int i = 0; i < 20000; ++i) {
        Vec3f d = random_direction(random);
        if (i % 3 == 0) d[i % 9 / 3] = 0;  // on the seams between the octahedron's faces
        d = d / length(d);
        const Vec3f e = d + random_direction(random) * 1e-5f;
        REQUIRE(std::fabs(at(d) - at(e)) < 2e-3f);
    }
}

TEST_CASE("a smooth function is interpolated to second order", "[directions]") {
    const auto error = [](std::uint32_t n) {
        const DirectionSet set(n);
        std::mt19937 random(3);
        double sum = 0;
        const int samples = 20000;
        const auto f = [](const Vec3d& d) { return d.x * d.y + 0.5 * d.z * d.z * d.z; };
        for (int i = 0; i < samples; ++i) {
            const Vec3f d = random_direction(random);
            const DirectionWeights w = set.interpolate(d);
            double v = 0;
            for (int k = 0; k < 3; ++k) v += static_cast<double>(w.weight[k]) * f(set.direction(w.index[k]));
            const double e = v - f(Vec3d(d) / length(Vec3d(d)));
            sum += e * e;
        }
        return std::sqrt(sum / samples);
    };
    const double coarse = error(4), fine = error(8);
    CHECK(coarse < 0.035);
    CHECK(coarse / fine > 3.4);
}

TEST_CASE("the face of an interpolation has its three directions as corners, in their order", "[directions]") {
    std::mt19937 random(3);
    for (const std::uint32_t n : {1u, 2u, 5u, 10u}) {
        const DirectionSet set(n);
        std::set<std::uint32_t> seen;
        for (int i = 0; i < 40000; ++i) {
            const DirectionWeights w = set.interpolate(random_direction(random));
            REQUIRE(w.face < set.faces());
            const auto corner = set.corners(w.face);
            if (w.weight[0] == 1) continue;
            for (std::size_t k = 0; k < 3; ++k) REQUIRE(corner[k] == w.index[k]);
            seen.insert(w.face);
        }
        CHECK(seen.size() == set.faces());
    }
}

TEST_CASE("earlier neighbours are next on the lattice, and each edge is one's once", "[directions]") {
    for (const std::uint32_t n : {1u, 2u, 3u, 8u}) {
        const DirectionSet set(n);
        std::set<std::pair<std::uint32_t, std::uint32_t>> found, edges;
        for (std::uint32_t d = 0; d < set.count(); ++d) {
            const Neighbours near = set.earlier_neighbours(d);
            for (std::uint32_t k = 0; k < near.count; ++k) {
                REQUIRE(near.index[k] < d);
                REQUIRE(found.emplace(near.index[k], d).second);
            }
        }
        for (std::uint32_t f = 0; f < set.faces(); ++f) {
            const auto c = set.corners(f);
            for (std::size_t k = 0; k < 3; ++k) edges.insert(std::minmax(c[k], c[(k + 1) % 3]));
        }
        CHECK(found == edges);
        CHECK(edges.size() == 12 * n * n);  // Euler: V - E + F = 2
    }
}
