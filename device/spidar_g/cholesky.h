// Cholesky's factors of a small symmetric matrix, in a fixed order of operations.
#pragma once

#include <cmath>

namespace frm::spidar_g {

/// Of the leading n x n part of a matrix of at most N rows. Plain + - * / and sqrt.
template <int N>
struct Cholesky {
    double l[N][N];
    double inverse[N];  ///< of the diagonal
    int n = 0;

    /// False if the matrix is not positive definite, or not of numbers.
    bool factor(const double (&a)[N][N], int size) {
        n = size;
        for (int i = 0; i < n; ++i) {
            for (int j = 0; j <= i; ++j) {
                double sum = a[i][j];
                for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
                if (j < i) {
                    l[i][j] = sum * inverse[j];
                } else {
                    if (!(sum > 0)) return false;
                    l[i][i] = std::sqrt(sum);
                    inverse[i] = 1 / l[i][i];
                }
            }
        }
        return true;
    }

    /// x = L^-1 b, in place.
    void forward(double* x) const {
        for (int i = 0; i < n; ++i) {
            double sum = x[i];
            for (int k = 0; k < i; ++k) sum -= l[i][k] * x[k];
            x[i] = sum * inverse[i];
        }
    }

    /// x = A^-1 b, in place.
    void solve(double* x) const {
        forward(x);
        for (int i = n - 1; i >= 0; --i) {
            double sum = x[i];
            for (int k = i + 1; k < n; ++k) sum -= l[k][i] * x[k];
            x[i] = sum * inverse[i];
        }
    }
};

}  // namespace frm::spidar_g
