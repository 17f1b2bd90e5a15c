#include "bake/flow/speed.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "bake/flow/domain.h"
#include "bake/flow/kernel.h"
#include "bake/flow/nest.h"
#include "bake/flow/threads.h"

namespace frm::bake {
namespace {

using namespace flow;
using Clock = std::chrono::steady_clock;

constexpr int side = 190;          // of the interior's block: 1 GB of populations, out of reach of any cache
constexpr double resolution = 48;  // of the nested run

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

/// The shortest of the times that `work` takes, repeated for `seconds`: what a quiet machine would give.
template <typename Work>
double shortest(double seconds, const Work& work) {
    work();
    double best = 1e30;
    const Clock::time_point begin = Clock::now();
    do {
        const Clock::time_point start = Clock::now();
        work();
        best = std::min(best, seconds_since(start));
    } while (seconds_since(begin) < seconds);
    return best;
}

double in_place_bandwidth(double seconds, int threads) {
    std::vector<float> memory(std::size_t{1} << 27, 1.0f);
    const auto count = static_cast<std::ptrdiff_t>(memory.size());
    float* const a = memory.data();
    const double time = shortest(seconds, [&] {
#pragma omp parallel for num_threads(threads) schedule(static)
        for (std::ptrdiff_t i = 0; i < count; ++i) a[i] = a[i] * 0.999f + 0.001f;
    });
    return 2.0 * sizeof(float) * static_cast<double>(count) / time * 1e-9;
}

double interior_rate(double seconds, int threads) {
    const Grid grid{side, side, side, false};
    Populations from(grid), to(grid);
    const std::vector<float> times(grid.pitch(), 0.5001f);
    Collision collision;
    collision.relaxation = times.data();
    collision.smagorinsky = 0.01f;
    Shares shares(grid.rows(), threads);
    const double time = shortest(seconds, [&] {
        shares.reset();
#pragma omp parallel num_threads(threads)
        shares.each([&](std::size_t r) { collide_row(grid, from, to, r, collision, {}); });
        std::swap(from, to);
    });
    return static_cast<double>(grid.cells()) / time * 1e-6;
}

/// A ball of facets, so that links of all directions and distances occur.
Surface ball() {
    Surface s;
    constexpr int rings = 24, sides = 48;
    constexpr double pi = 3.14159265358979323846;
    for (int r = 0; r <= rings; ++r) {
        for (int i = 0; i < sides; ++i) {
            const double polar = pi * r / rings, around = 2 * pi * i / sides;
            s.vertices.push_back({0.5 * std::sin(polar) * std::cos(around), 0.5 * std::sin(polar) * std::sin(around),
                                  0.5 * std::cos(polar)});
        }
    }
    for (std::uint32_t r = 0; r < rings; ++r) {
        for (std::uint32_t i = 0; i < sides; ++i) {
            const std::uint32_t a = r * sides + i, b = r * sides + (i + 1) % sides;
            s.triangles.push_back({a, a + sides, b + sides});
            s.triangles.push_back({a, b + sides, b});
        }
    }
    return s;
}

double nested_rate(double seconds, int threads) {
    FlowCase c;
    c.direction = {1, 0, 0};
    c.speed = 1;
    c.viscosity = 1e-4;
    c.resolution = resolution;
    const Surface surface = ball();
    const Domain domain = plan_domain(surface, c);
    Regions one{std::vector<std::uint32_t>(surface.triangles.size(), 0), 1};
    Body body = cut_links(domain, one);
    Wall wall(body.links, 1, Populations::apart(domain.finest()));
    Nest nest(domain, std::move(body.solid), wall, threads);
    std::vector<Load> loads(1);
    const double time = shortest(seconds, [&] { nest.advance([&](std::uint64_t) { wall.sum(loads); }); });
    const double updates = domain.plan.updates / static_cast<double>(domain.plan.steps);
    return updates * static_cast<double>(nest.steps_at_once()) / time * 1e-6;
}

}  // namespace

FlowSpeed measure_flow_speed(double seconds, int wanted) {
    const int threads = thread_count(wanted);
    FlowSpeed speed;
    speed.bandwidth = in_place_bandwidth(seconds, threads);
    speed.roof = speed.bandwidth * 1e3 / (2.0 * direction_count * sizeof(float));
    speed.kernel = interior_rate(seconds, threads);
    speed.nested = nested_rate(seconds, threads);
    return speed;
}

}  // namespace frm::bake
