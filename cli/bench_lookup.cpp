#include "cli/bench_lookup.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "core/body/body.h"
#include "core/map/codec.h"

namespace frm::cli {
namespace {

constexpr std::size_t batch = 512;  ///< ticks between two looks at the clock

std::vector<Twist> stroke() {
    std::vector<Twist> out;
    for (std::size_t n = 0; n < 4 * batch; ++n) {
        const auto phase = static_cast<float>(n) * (6.2831853f / (4 * batch));
        out.push_back({{0.6f * std::cos(phase), 0.4f, 0.2f * std::sin(phase)}, {0.5f * std::sin(phase), 0.3f, 0.2f}});
    }
    return out;
}

std::vector<Twist> scatter() {
    std::vector<Twist> out;
    std::mt19937 random(1);
    std::uniform_real_distribution<float> number(-1, 1);
    const auto any = [&] { return Vec3f(number(random), number(random), number(random)); };
    for (std::size_t n = 0; n < 4 * batch; ++n) out.push_back({any(), any()});
    return out;
}

/// Nanoseconds of one tick's resistance.
double measure(Body& body, const std::vector<Twist>& twists, double seconds) {
    SurfaceView surface;
    surface.everywhere = true;
    const Fluid fluid;
    measure_wet_surface(body, surface, fluid);
    using Clock = std::chrono::steady_clock;
    std::vector<double> times;
    std::size_t n = 0;
    const auto begin = Clock::now();
    while (times.size() < 9 || std::chrono::duration<double>(Clock::now() - begin).count() < seconds) {
        const auto start = Clock::now();
        for (std::size_t i = 0; i < batch; ++i, ++n) {
            body.def.twist = twists[n % twists.size()];
            look_up_resistance(body, surface, fluid, 0.002f, model_default, skip_default);
        }
        times.push_back(std::chrono::duration<double, std::nano>(Clock::now() - start).count() / batch);
    }
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    return times[times.size() / 2];
}

}  // namespace

LookupTimes measure_lookup(const std::vector<std::uint8_t>& map_file, double seconds) {
    const auto map = std::make_shared<Map>();
    decode_map(map_file.data(), map_file.size(), *map);
    BodyDef def;
    def.map = map;
    Body body(def, 0, std::pmr::get_default_resource());
    const auto sources = static_cast<double>(map->sources.size());
    LookupTimes out{};
    out.source = measure(body, stroke(), seconds) / sources;
    out.scattered = measure(body, scatter(), seconds) / sources;
    body.budget.error = 1e30f;
    out.coarse = measure(body, stroke(), seconds);
    return out;
}

}  // namespace frm::cli
