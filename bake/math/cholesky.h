// Dense symmetric positive definite systems of a few thousand unknowns. In one fixed order of operations, so that a map
// is the same bytes on every machine; a BLAS promises that neither between processors nor between numbers of threads.
#pragma once

#include <cstddef>
#include <vector>

namespace frm::bake {

/// The lower factor L of A = L L^T, packed row by row: (i, j), j <= i, at i (i + 1) / 2 + j.
class Cholesky {
public:
    /// Takes A's lower half, packed alike. Throws BakeError if A is not positive definite to within rounding.
    /// The same bits for any number of threads (0: OpenMP's own).
    Cholesky(std::vector<double> lower, std::size_t size, int threads = 1);

    /// Replaces b by the solution of A x = b.
    void solve(double* b) const;
    /// The diagonal of the inverse of A.
    std::vector<double> inverse_diagonal() const;
    std::size_t size() const { return size_; }

private:
    std::vector<double> factor_;
    std::size_t size_;
};

}  // namespace frm::bake
