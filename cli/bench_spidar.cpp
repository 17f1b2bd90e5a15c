#include "cli/bench_spidar.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <vector>

#include "device/spidar_g/configuration.h"
#include "device/spidar_g/kinematics.h"
#include "device/spidar_g/tensions.h"

namespace frm::cli {
namespace {

using namespace spidar_g;
using Clock = std::chrono::steady_clock;

constexpr std::size_t samples = 2048;

double microseconds_since(Clock::time_point then) {
    return std::chrono::duration<double, std::micro>(Clock::now() - then).count();
}

/// The median, over batches of all samples, of one call's time.
template <typename Work>
double median(double seconds, const Work& work) {
    std::vector<double> times;
    const Clock::time_point begin = Clock::now();
    while (times.size() < 9 || microseconds_since(begin) < seconds * 1e6) {
        const Clock::time_point start = Clock::now();
        for (std::size_t n = 0; n < samples; ++n) work(n);
        times.push_back(microseconds_since(start) / samples);
    }
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    return times[times.size() / 2];
}

/// Around a circle of 30 mm in as many cycles as take it at 1 m/s, so that the last pose is next to the first.
GripPose on_circle(std::size_t n) {
    const double phase = 6.283185307179586 * static_cast<double>(n * 11 % samples) / samples;
    return {{0.03 * std::cos(phase), 0.03 * std::sin(phase), 0}, turned({}, {0, 0.3 * std::sin(phase), 0})};
}

struct Asked {
    StringRows rows;
    GripWrench wrench;
};

double worst_tensions(const Configuration& c, double seconds) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> number(-1, 1);
    const auto any = [&](double most) { return Vec3d(number(random), number(random), number(random)) * most; };
    std::vector<Asked> asked(samples);
    for (std::size_t n = 0; n < samples; ++n) {
        string_rows(c.geometry, {any(0.025), turned({}, any(0.4))}, asked[n].rows);
        Tensions t;
        for (double& x : t) x = 10.15 + 9.85 * number(random);
        const GripWrench w = wrench_of(asked[n].rows, t, c.geometry.lever);
        const double scale = n % 2 ? 1 : 4;
        asked[n].wrench = {w.force * scale, w.torque * scale};
    }
    TensionSolver solver(c.limits);
    std::vector<double> times;
    const Clock::time_point begin = Clock::now();
    while (times.size() < samples || microseconds_since(begin) < seconds * 1e6) {
        const Asked& a = asked[times.size() % samples];
        const Clock::time_point start = Clock::now();
        solver.solve(a.rows, a.wrench, c.geometry.lever);
        times.push_back(microseconds_since(start));
    }
    const auto at = static_cast<std::ptrdiff_t>(times.size() * 99 / 100);
    std::nth_element(times.begin(), times.begin() + at, times.end());
    return times[static_cast<std::size_t>(at)];
}

}  // namespace

SpidarTimes measure_spidar(double seconds) {
    const Configuration c = load_configuration(nullptr);
    std::vector<Lengths> lengths(samples);
    std::vector<Asked> asked(samples);
    for (std::size_t n = 0; n < samples; ++n) {
        string_rows(c.geometry, on_circle(n), asked[n].rows);
        for (std::size_t i = 0; i < string_count; ++i) {
            const double pulse = std::fabs(c.motors[i].metres_per_pulse);
            lengths[n][i] = (std::floor(asked[n].rows.length[i] / pulse) + 0.5) * pulse;
        }
        const double phase = 6.283185307179586 * static_cast<double>(n) / samples;
        asked[n].wrench = {{6 * std::cos(phase), 4 * std::sin(3 * phase), 2}, {0, 0.05 * std::sin(phase), 0.02}};
    }
    SpidarTimes out{};
    GripPose pose = on_circle(0);
    out.pose = median(seconds, [&](std::size_t n) { pose = fit_pose(c.geometry, lengths[n], pose).pose; });
    TensionSolver solver(c.limits);
    out.tensions =
        median(seconds, [&](std::size_t n) { solver.solve(asked[n].rows, asked[n].wrench, c.geometry.lever); });
    out.tensions_worst = worst_tensions(c, seconds);
    return out;
}

}  // namespace frm::cli
