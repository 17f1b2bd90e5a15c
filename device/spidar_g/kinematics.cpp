#include "device/spidar_g/kinematics.h"

#include <cmath>

#include "device/spidar_g/cholesky.h"

namespace frm::spidar_g {
namespace {

// Rows are of one unit and about one, so this is relative: it holds at poses where the strings leave a direction free,
// and is far too small to make the pose lag (1e-3 lags by 1 degree at 1 m/s).
constexpr double damping = 1e-6;

// Steps shrink at least a thousandfold near the end, with lengths as wrong as the checks let pass: what is left after
// one of a micrometre is below a thousandth of an encoder's count.
constexpr double small_step = 1e-6;

bool normal_matrix(const StringRows& rows, Cholesky<6>& factors) {
    double a[6][6];
    for (int i = 0; i < 6; ++i) {
        for (int j = 0; j <= i; ++j) {
            double sum = 0;
            for (int s = 0; s < string_count; ++s) sum += rows.row[s][i] * rows.row[s][j];
            a[i][j] = sum;
        }
        a[i][i] += damping;
    }
    return factors.factor(a, 6);
}

void judge(PoseFit& fit, const Lengths& lengths, const Cholesky<6>& factors) {
    double squares = 0;
    for (int s = 0; s < string_count; ++s) {
        const auto i = static_cast<std::size_t>(s);
        const double r = lengths[i] - fit.rows.length[i];
        double half[6], leverage = 0;
        for (int k = 0; k < 6; ++k) half[k] = fit.rows.row[s][k];
        factors.forward(half);
        for (const double h : half) leverage += h * h;
        const double rest = 1 - leverage;
        fit.residual[i] = r;
        fit.normalised_residual[i] = r / std::sqrt(rest > 1e-3 ? rest : 1e-3);
        squares += r * r;
    }
    fit.residual_rms = std::sqrt(squares / string_count);
}

}  // namespace

PoseFit fit_pose(const Geometry& geometry, const Lengths& lengths, const GripPose& start) {
    PoseFit fit;
    fit.pose = start;
    Cholesky<6> factors;
    bool good = string_rows(geometry, fit.pose, fit.rows);
    while (good && !fit.converged && fit.iterations < pose_iterations) {
        ++fit.iterations;
        good = normal_matrix(fit.rows, factors);
        if (!good) break;
        double step[6] = {}, largest = 0;
        for (int s = 0; s < string_count; ++s) {
            const auto i = static_cast<std::size_t>(s);
            const double r = fit.rows.length[i] - lengths[i];
            for (int k = 0; k < 6; ++k) step[k] += fit.rows.row[s][k] * r;
        }
        factors.solve(step);
        for (const double c : step) largest = std::fabs(c) > largest ? std::fabs(c) : largest;
        if (!(largest < 1e2 * geometry.lever)) break;  // also if it is not a number
        fit.pose.position += Vec3d(step[0], step[1], step[2]);
        fit.pose.rotation = turned(fit.pose.rotation, Vec3d(step[3], step[4], step[5]) / geometry.lever);
        good = string_rows(geometry, fit.pose, fit.rows);
        fit.converged = good && largest < small_step;
    }
    if (fit.converged) {
        judge(fit, lengths, factors);
    } else {
        fit.pose = start;
        if (!string_rows(geometry, start, fit.rows)) fit.pose = {};
    }
    return fit;
}

}  // namespace frm::spidar_g
