#include "cli/bench_body.h"

#include <chrono>
#include <cmath>
#include <memory>
#include <memory_resource>
#include <vector>

#include "cli/tick_times.h"
#include "core/map/codec.h"
#include "core/water/coupling.h"
#include "core/world/world.h"

namespace frm::cli {
namespace {

/// The median of what `call` takes, of batches of sixteen calls so that the clock does not count; `prepare(n)` before each
/// call is not counted: it is measured by itself and taken off.
template <typename Prepare, typename Call>
double median_us(double seconds, Prepare&& prepare, Call&& call) {
    const auto now = [] { return std::chrono::steady_clock::now(); };
    TickTimes with, without;
    std::size_t n = 0;
    constexpr std::size_t batch = 16;
    for (const auto begin = now(); n < 64 || std::chrono::duration<double>(now() - begin).count() < seconds;) {
        const auto start = now();
        for (std::size_t k = 0; k < batch; ++k) prepare(n + k);
        const auto middle = now();
        for (std::size_t k = 0; k < batch; ++k) prepare(n + k), call();
        const auto end = now();
        n += batch;
        without.add(std::chrono::duration<double, std::micro>(middle - start).count() / batch);
        with.add(std::chrono::duration<double, std::micro>(end - middle).count() / batch);
    }
    return with.quantile(0.5) - without.quantile(0.5);
}

}  // namespace

BodyTimes measure_body(const std::vector<std::uint8_t>& map_file, double seconds) {
    const auto map = std::make_shared<Map>();
    decode_map(map_file.data(), map_file.size(), *map);
    World world(WorldDef(), 1, std::pmr::get_default_resource());
    WaterDef water_def;
    water_def.field = {200, 200, 0.025f, 1.0f, Border::absorbing, 16};
    Water& water = world.create_water(water_def);
    BodyDef def;
    def.map = map;
    Body& body = world.create_body(def);
    const Fluid fluid;
    const auto move = [&](std::size_t n, double z) {
        const double phase = 0.004 * static_cast<double>(n), angle = 0.2 * std::sin(phase);
        const Quat<float> q{static_cast<float>(std::sin(angle)), 0, 0, static_cast<float>(std::cos(angle))};
        body.def.pose = {{0.3 * std::sin(phase), 0, z}, q};
        body.rotation = Rotation<float>(q);
    };
    const auto view = [&] {
        SurfaceView v;
        v.level = static_cast<float>(-body.def.pose.position.z);
        v.field = &water.field;
        v.origin = water.origin_at(body.def.pose.position.x, body.def.pose.position.y);
        v.cells_per_metre = 1.0f / water_def.field.cell;
        return v;
    };
    const auto begin = [&] {
        const SurfaceView v = view();
        body.footprint->begin(v.origin.i, v.origin.j, v.origin, &water.field);
        return v;
    };
    BodyTimes t;
    const auto wet_surface = [&](double z) {
        return median_us(
            seconds, [&](std::size_t n) { move(n, z); }, [&] { measure_wet_surface(body, view(), fluid); });
    };
    t.calm = wet_surface(-1);
    std::vector<float> waves(water.field.cells());
    for (std::size_t i = 0; i < waves.size(); ++i)
        waves[i] = static_cast<float>(0.01 * std::sin(0.2 * static_cast<double>(i % 200)));
    world.set_height(waves.data());
    t.cut = wet_surface(0);
    t.wet = wet_surface(-1);
    const auto lay = [&] {
        begin();
        lay_displacement(body, static_cast<float>(-body.def.pose.position.z), true);
    };
    t.displacement = median_us(
        seconds, [&](std::size_t n) { move(n, 0); }, [&] { lay(), body.footprint->end(); });
    t.coupling = median_us(
        seconds, [&](std::size_t n) { move(n, 0), lay(); },
        [&] { displace_water(*body.footprint, water.field), body.footprint->end(); });
    t.still = median_us(
        seconds, [&](std::size_t) {}, [&] { lay(), body.footprint->end(); });
    return t;
}

}  // namespace frm::cli
