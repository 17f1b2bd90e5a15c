#include "device/servo/drag_limit.h"

#include <algorithm>
#include <cmath>

namespace frm::device {
namespace {

// Of M / T: half of where a linear loop swings by itself (docs/haptic-stability.md).
constexpr double share_borne = 0.25;
// Cycles in which the late part comes, for each time that the damping D is too much. With what is borne, D / r = M / (4 T),
// and a late part of time s T r, small motion obeys M s T r x'' + (M + M s r / 4) x' + D x = 0: damped by sqrt(s) / 4,
// before what the delay of two cycles takes away again. 8 leaves 0.7.
constexpr double settling = 8;

using Vector6 = std::array<double, 6>;

struct Eigen {
    Vector6 values{};
    Matrix6 vectors{};  ///< rows
};

/// Jacobi's cyclic method, for a symmetric matrix.
Eigen eigen(Matrix6 a) {
    Eigen out;
    for (std::size_t i = 0; i < 6; ++i) out.vectors[7 * i] = 1;
    double size = 0;
    for (const double v : a) size += v * v;
    for (int sweep = 0; sweep < 8; ++sweep) {
        double off = 0;
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t j = 0; j < i; ++j) off += a[6 * i + j] * a[6 * i + j];
        if (!(off > 1e-20 * size)) break;
        for (std::size_t p = 0; p < 5; ++p)
            for (std::size_t q = p + 1; q < 6; ++q) {
                const double pq = a[6 * p + q];
                if (pq == 0) continue;
                const double theta = (a[7 * q] - a[7 * p]) / (2 * pq);
                const double t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::sqrt(1 + theta * theta));
                const double c = 1 / std::sqrt(1 + t * t), s = t * c;
                for (std::size_t k = 0; k < 6; ++k) {
                    const double x = a[6 * k + p], y = a[6 * k + q];
                    a[6 * k + p] = c * x - s * y;
                    a[6 * k + q] = s * x + c * y;
                }
                for (std::size_t k = 0; k < 6; ++k) {
                    const double x = a[6 * p + k], y = a[6 * q + k];
                    a[6 * p + k] = c * x - s * y;
                    a[6 * q + k] = s * x + c * y;
                    const double u = out.vectors[6 * p + k], v = out.vectors[6 * q + k];
                    out.vectors[6 * p + k] = c * u - s * v;
                    out.vectors[6 * q + k] = s * u + c * v;
                }
            }
    }
    for (std::size_t i = 0; i < 6; ++i) out.values[i] = a[7 * i];
    return out;
}

}  // namespace

Matrix6 about(const Vec3d& arm, const Matrix6& damping) {
    // Columns and rows of a motion and a wrench there: X D X^T, X = (1 0; arm x, 1).
    Matrix6 half{}, out{};
    const double x[9] = {0, -arm.z, arm.y, arm.z, 0, -arm.x, -arm.y, arm.x, 0};
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) {
            half[6 * i + j] = damping[6 * i + j];
            if (i >= 3)
                for (std::size_t k = 0; k < 3; ++k) half[6 * i + j] += x[3 * (i - 3) + k] * damping[6 * k + j];
        }
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) {
            out[6 * i + j] = half[6 * i + j];
            if (j >= 3)
                for (std::size_t k = 0; k < 3; ++k) out[6 * i + j] += half[6 * i + k] * x[3 * (j - 3) + k];
        }
    return out;
}

Wrench DragLimit::limit(const Wrench& wrench, const Matrix6& damping, double dt, const Grip& grip) {
    // With lengths and forces in units of the grip's own inertia the damping has the rates of decay for eigenvalues.
    const double unit[2] = {std::sqrt(std::max(grip.linear, 0.0)), std::sqrt(std::max(grip.angular, 0.0))};
    Vector6 force{};
    for (std::size_t i = 0; i < 3; ++i) {
        const int k = static_cast<int>(i);
        force[i] = static_cast<double>(wrench.force[k]) * unit[0];
        force[i + 3] = static_cast<double>(wrench.torque[k]) * unit[1];
    }
    Matrix6 rates;
    double trace = 0;
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j) {
            rates[6 * i + j] = damping[6 * i + j] * unit[i / 3] * unit[j / 3];
            if (i == j) trace += rates[6 * i + j];
        }
    const double most = share_borne / dt;
    excess_ = trace / most;
    // No eigenvalue is larger than the trace.
    if (!begun_ || !(trace > most)) {
        slow_ = force;
        begun_ = true;
        return wrench;
    }
    const Eigen e = eigen(rates);
    excess_ = *std::max_element(e.values.begin(), e.values.end()) / most;
    Vector6 out{}, slow{};
    for (std::size_t k = 0; k < 6; ++k) {
        const double* const direction = &e.vectors[6 * k];
        double now = 0, late = 0;
        for (std::size_t i = 0; i < 6; ++i) now += direction[i] * force[i], late += direction[i] * slow_[i];
        const double excess = std::max(e.values[k] / most, 1.0);
        late = excess > 1 ? late + (now - late) / (1 + settling * excess) : now;
        const double felt = late + (now - late) / excess;
        for (std::size_t i = 0; i < 6; ++i) out[i] += direction[i] * felt, slow[i] += direction[i] * late;
    }
    slow_ = slow;
    Wrench result = wrench;  // what the host scales to nothing stays
    const auto part = [](double v) { return static_cast<float>(v); };
    if (unit[0] > 0) result.force = Vec3f(part(out[0] / unit[0]), part(out[1] / unit[0]), part(out[2] / unit[0]));
    if (unit[1] > 0) result.torque = Vec3f(part(out[3] / unit[1]), part(out[4] / unit[1]), part(out[5] / unit[1]));
    return result;
}

}  // namespace frm::device
