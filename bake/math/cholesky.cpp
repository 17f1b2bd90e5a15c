#include "bake/math/cholesky.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bake/error.h"
#include "bake/flow/threads.h"

namespace frm::bake {
namespace {

double* row(std::vector<double>& packed, std::size_t i) { return packed.data() + i * (i + 1) / 2; }
const double* row(const std::vector<double>& packed, std::size_t i) { return packed.data() + i * (i + 1) / 2; }

/// Four running sums: one would be a chain of additions that each wait for the last.
double dot(const double* a, const double* b, std::size_t n) {
    double s[4] = {};
    std::size_t k = 0;
    for (; k + 4 <= n; k += 4)
        for (std::size_t i = 0; i < 4; ++i) s[i] += a[k + i] * b[k + i];
    for (; k < n; ++k) s[0] += a[k] * b[k];
    return (s[0] + s[1]) + (s[2] + s[3]);
}

}  // namespace

// By bands of columns: the rows of a band stay in the cache while all rows below are reduced by them, by several threads.
// Each element is the same sum in the same order, whatever the bands and the threads.
Cholesky::Cholesky(std::vector<double> lower, std::size_t size, int threads) : factor_(std::move(lower)), size_(size) {
    constexpr std::size_t band = 32;
    const auto reduce = [this](std::size_t i, std::size_t j) {
        double* const a = row(factor_, i);
        a[j] = (a[j] - dot(a, row(factor_, j), j)) / row(factor_, j)[j];
    };
    for (std::size_t first = 0; first < size; first += band) {
        const std::size_t end = std::min(first + band, size);
        for (std::size_t i = first; i < end; ++i) {
            for (std::size_t j = first; j < i; ++j) reduce(i, j);
            double* const a = row(factor_, i);
            const double rest = a[i] - dot(a, a, i);
            if (!(rest > 1e-14 * a[i])) throw BakeError("math: a matrix that should be positive definite is not");
            a[i] = std::sqrt(rest);
        }
        const auto n = static_cast<std::ptrdiff_t>(size);
#pragma omp parallel for num_threads(flow::thread_count(threads)) schedule(dynamic, 8)
        for (std::ptrdiff_t i = static_cast<std::ptrdiff_t>(end); i < n; ++i) {
            for (std::size_t j = first; j < end; ++j) reduce(static_cast<std::size_t>(i), j);
        }
    }
}

void Cholesky::solve(double* b) const {
    for (std::size_t i = 0; i < size_; ++i) b[i] = (b[i] - dot(row(factor_, i), b, i)) / row(factor_, i)[i];
    for (std::size_t i = size_; i-- > 0;) {
        const double* const a = row(factor_, i);
        b[i] /= a[i];
        for (std::size_t j = 0; j < i; ++j) b[j] -= a[j] * b[i];
    }
}

std::vector<double> Cholesky::inverse_diagonal() const {
    std::vector<double> diagonal(size_), column(size_);
    for (std::size_t i = 0; i < size_; ++i) {
        column.assign(size_, 0.0);
        column[i] = 1;
        solve(column.data());
        diagonal[i] = column[i];
    }
    return diagonal;
}

}  // namespace frm::bake
