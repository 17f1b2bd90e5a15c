#include "device/spidar_g/wrench_range.h"

#include <cmath>

namespace frm::spidar_g {
namespace {

/// The vector orthogonal to five others in six dimensions; false if they are (nearly) dependent.
bool orthogonal(const double (&in)[5][6], double (&normal)[6]) {
    double a[5][6];
    int column[6] = {0, 1, 2, 3, 4, 5};
    for (int i = 0; i < 5; ++i)
        for (int k = 0; k < 6; ++k) a[i][k] = in[i][k];
    for (int i = 0; i < 5; ++i) {
        int row = i, pivot = i;
        for (int r = i; r < 5; ++r)
            for (int c = i; c < 6; ++c)
                if (std::fabs(a[r][c]) > std::fabs(a[row][pivot])) row = r, pivot = c;
        if (std::fabs(a[row][pivot]) < 1e-7) return false;
        for (int k = 0; k < 6; ++k) std::swap(a[i][k], a[row][k]);
        for (int r = 0; r < 5; ++r) std::swap(a[r][i], a[r][pivot]);
        std::swap(column[i], column[pivot]);
        for (int r = 0; r < 5; ++r) {
            if (r == i) continue;
            const double f = a[r][i] / a[i][i];
            for (int k = i; k < 6; ++k) a[r][k] -= f * a[i][k];
        }
    }
    double squares = 1;
    normal[column[5]] = 1;
    for (int i = 0; i < 5; ++i) {
        normal[column[i]] = -a[i][5] / a[i][i];
        squares += normal[column[i]] * normal[column[i]];
    }
    for (double& n : normal) n /= std::sqrt(squares);
    return true;
}

}  // namespace

WrenchRange wrench_range(const StringRows& rows, const TensionLimits& limits, double lever) {
    WrenchRange out;
    double nearest = 1e300, force = 1e300, torque = 1e300, cone = 1e300;
    for (int i = 0; i < string_count; ++i) {
        for (int j = i + 1; j < string_count; ++j) {
            for (int k = j + 1; k < string_count; ++k) {
                // Five of eight: all but three.
                double five[5][6], normal[6];
                int n = 0;
                for (int s = 0; s < string_count; ++s) {
                    if (s == i || s == j || s == k) continue;
                    for (int c = 0; c < 6; ++c) five[n][c] = rows.row[s][c];
                    ++n;
                }
                if (!orthogonal(five, normal)) continue;
                out.full_rank = out.full_rank || [&] {
                    for (const int s : {i, j, k}) {
                        double along = 0;
                        for (int c = 0; c < 6; ++c) along += rows.row[s][c] * normal[c];
                        if (std::fabs(along) > 1e-6) return true;
                    }
                    return false;
                }();
                for (const double side : {1.0, -1.0}) {
                    // How far the wrenches reach along the normal: pulling strings pull their most, the others their
                    // least.
                    double reach = 0, unlimited = 0;
                    for (int s = 0; s < string_count; ++s) {
                        double along = 0;
                        for (int c = 0; c < 6; ++c) along += side * rows.row[s][c] * normal[c];
                        const auto u = static_cast<std::size_t>(s);
                        reach += along * (along > 0 ? limits.high[u] : limits.low[u]);
                        if (along > 0) unlimited += along;
                    }
                    const double f = length(Vec3d(normal[0], normal[1], normal[2]));
                    const double m = length(Vec3d(normal[3], normal[4], normal[5]));
                    nearest = std::fmin(nearest, reach);
                    cone = std::fmin(cone, unlimited);
                    if (f > 1e-9) force = std::fmin(force, reach / f);
                    if (m > 1e-9) torque = std::fmin(torque, reach / m);
                }
            }
        }
    }
    out.closure = out.full_rank && cone > 1e-6;
    out.rest = out.closure && nearest > 0;
    if (out.rest) {
        out.force = force;
        out.torque = torque * lever;
    }
    return out;
}

}  // namespace frm::spidar_g
