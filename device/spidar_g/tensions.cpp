#include "device/spidar_g/tensions.h"

#include <cmath>

#include "device/spidar_g/cholesky.h"

namespace frm::spidar_g {
namespace {

constexpr double smoothing = 1e-6;

// Of a Lagrange multiplier, in N: what rounding leaves of one that is zero.
constexpr double tolerance = 1e-9;

struct Problem {
    double h[string_count][string_count];  ///< W'W + smoothing
    double g[string_count];                ///< W'w
};

Problem make_problem(const StringRows& rows, const double (&w)[6]) {
    Problem p;
    for (int i = 0; i < string_count; ++i) {
        for (int j = 0; j <= i; ++j) {
            double sum = 0;
            for (int k = 0; k < 6; ++k) sum += rows.row[i][k] * rows.row[j][k];
            p.h[i][j] = p.h[j][i] = sum;
        }
        p.h[i][i] += smoothing;
        p.g[i] = 0;
        for (int k = 0; k < 6; ++k) p.g[i] += rows.row[i][k] * w[k];
    }
    return p;
}

double gradient(const Problem& p, const Tensions& t, int i) {
    double sum = -p.g[i];
    for (int j = 0; j < string_count; ++j) sum += p.h[i][j] * t[static_cast<std::size_t>(j)];
    return sum;
}

}  // namespace

TensionSolver::TensionSolver(const TensionLimits& limits) : limits_(limits) { reset(); }

void TensionSolver::reset() {
    for (At& at : at_) at = At::low;
    last_ = limits_.low;
}

TensionResult TensionSolver::solve(const StringRows& rows, const GripWrench& wrench, double lever) {
    const double w[6] = {wrench.force.x,          wrench.force.y,          wrench.force.z,
                         wrench.torque.x / lever, wrench.torque.y / lever, wrench.torque.z / lever};
    double sum = 0;
    for (int i = 0; i < string_count; ++i)
        for (int k = 0; k < 6; ++k) sum += rows.row[i][k] * w[k];
    TensionResult out{limits_.low};
    if (!(std::fabs(sum) < 1e12)) {
        reset();
        return out;
    }

    const Problem p = make_problem(rows, w);
    Tensions& t = last_;
    while (!out.optimal && out.iterations < tension_iterations) {
        ++out.iterations;
        // The minimum over the free strings, the others staying where they are.
        int free[string_count], n = 0;
        for (int i = 0; i < string_count; ++i)
            if (at_[i] == At::free) free[n++] = i;
        int blocking = -1;
        if (n > 0) {
            double a[string_count][string_count], x[string_count];
            for (int i = 0; i < n; ++i) {
                x[i] = -gradient(p, t, free[i]);
                for (int j = 0; j <= i; ++j) a[i][j] = p.h[free[i]][free[j]];
            }
            Cholesky<string_count> factors;
            if (!factors.factor(a, n)) break;
            factors.solve(x);
            double step = 1;
            for (int i = 0; i < n; ++i) {
                const auto s = static_cast<std::size_t>(free[i]);
                const double room = (x[i] < 0 ? limits_.low[s] : limits_.high[s]) - t[s];
                if (std::fabs(x[i]) * step > std::fabs(room)) {
                    step = room / x[i];
                    blocking = i;
                }
            }
            for (int i = 0; i < n; ++i) {
                const auto s = static_cast<std::size_t>(free[i]);
                t[s] += step * x[i];
                if (!(t[s] > limits_.low[s])) t[s] = limits_.low[s];
                if (!(t[s] < limits_.high[s])) t[s] = limits_.high[s];
            }
            if (blocking >= 0) {
                const int i = free[blocking];
                at_[i] = x[blocking] < 0 ? At::low : At::high;
                t[static_cast<std::size_t>(i)] = at_[i] == At::low ? limits_.low[static_cast<std::size_t>(i)]
                                                                   : limits_.high[static_cast<std::size_t>(i)];
                continue;
            }
        }
        // Whom the objective pulls off its limit hardest is let go.
        int let_go = -1;
        double hardest = tolerance;
        for (int i = 0; i < string_count; ++i) {
            if (at_[i] == At::free) continue;
            const double slope = gradient(p, t, i), pull = at_[i] == At::low ? -slope : slope;
            if (pull > hardest) {
                hardest = pull;
                let_go = i;
            }
        }
        if (let_go < 0)
            out.optimal = true;
        else
            at_[let_go] = At::free;
    }
    out.tensions = t;
    return out;
}

}  // namespace frm::spidar_g
