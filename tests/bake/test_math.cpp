// Dense systems.
#include <cstddef>
#include <vector>

#include "bake/error.h"
#include "bake/math/cholesky.h"
#include "tests/support/catch.h"

using namespace frm::bake;

TEST_CASE("a positive definite system is solved, and its inverse's diagonal is that of the solutions") {
    // Hilbert's matrix of order 5: condition 5e5, inverse in whole numbers.
    constexpr std::size_t n = 5;
    std::vector<double> lower;
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j <= i; ++j) lower.push_back(1.0 / static_cast<double>(i + j + 1));
    const Cholesky factor(lower, n);
    const double diagonal[n] = {25, 4800, 79380, 179200, 44100};
    const std::vector<double> found = factor.inverse_diagonal();
    for (std::size_t i = 0; i < n; ++i) REQUIRE(found[i] == Approx(diagonal[i]).epsilon(1e-9));
    double b[n] = {1, 0, 0, 0, 0};
    factor.solve(b);
    REQUIRE(b[4] == Approx(630).epsilon(1e-9));
    REQUIRE_THROWS_AS(Cholesky({1, 2, 1}, 2), BakeError);
}
