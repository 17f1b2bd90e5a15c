#include "cli/bench_waves.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>
#include <memory_resource>
#include <vector>

#include "core/kernels/kernels.h"
#include "core/water/field.h"

namespace frm::cli {
namespace {

using Clock = std::chrono::steady_clock;
constexpr float gravity = 9.80665f;

template <typename Work>
double microseconds(std::uint32_t repeats, const Work& work) {
    const Clock::time_point start = Clock::now();
    for (std::uint32_t n = 0; n < repeats; ++n) work();
    return std::chrono::duration<double, std::micro>(Clock::now() - start).count() / repeats;
}

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

FieldDef def_of(std::int32_t cells, std::int32_t order) {
    FieldDef def;
    def.nx = def.ny = cells;
    def.cell = 0.025f;
    def.depth = 0.5f;
    def.order = order;
    return def;
}

}  // namespace

WaveSpeed measure_wave_speed(std::int32_t cells, std::int32_t order, std::uint32_t steps, double seconds) {
    FieldDef def = def_of(cells, order);
    def.border = Border::reflecting;  // or the waves would run out
    Field field(def, std::pmr::get_default_resource());
    std::vector<float> height;
    for (std::int32_t j = 0; j < cells; ++j)
        for (std::int32_t i = 0; i < cells; ++i)
            height.push_back(0.01f * std::sin(0.3f * static_cast<float>(i)) * std::cos(0.2f * static_cast<float>(j)));
    field.set_heights(height.data());
    const auto count = static_cast<std::ptrdiff_t>(3 * field.cells());
    std::vector<float> memory(static_cast<std::size_t>(count) + 16, 1.0f);
    void* begin_of_memory = memory.data();
    std::size_t room = memory.size() * sizeof(float);
    auto* const aligned = static_cast<float*>(std::align(64, 64, begin_of_memory, room));
    const Kernels& kernel = kernels();
    // So many at once that the clock's own time does not count.
    const auto repeats = static_cast<std::uint32_t>(std::max<std::size_t>(1, 400000 / field.cells()));

    WaveSpeed speed;
    speed.bytes = 24.0 * static_cast<double>(field.cells());
    speed.step_us = speed.roof_us = 1e30;
    const Clock::time_point begin = Clock::now();
    do {
        for (int n = 0; n < 3; ++n) {
            speed.roof_us =
                std::min(speed.roof_us, microseconds(repeats, [&] { kernel.scale(aligned, count, 0.99999994f); }));
        }
        for (int n = 0; n < 3; ++n) {
            const double us =
                microseconds(repeats, [&] { field.advance(0.002f, gravity, steps, nullptr, 0, 1); }) / steps;
            speed.step_us = std::min(speed.step_us, us);
        }
    } while (seconds_since(begin) < seconds);
    return speed;
}

double measure_active_waves(std::int32_t order, double seconds) {
    FieldDef def = def_of(2048, order);
    def.calm = 1e-5f;
    Field field(def, std::pmr::get_default_resource());
    std::vector<double> times;
    const Clock::time_point begin = Clock::now();
    const std::int32_t first = 1024, size = 64, around = 2 * CalmTiles::side;
    do {
        // Waves in two by two tiles, and the steps until the tiles are looked at, with the look: no wave has left by then.
        for (std::int32_t j = first - around; j < first + size + around; ++j)
            for (float* const row : {field.height_row(j), field.velocity_x_row(j), field.velocity_y_row(j)})
                std::fill_n(row + first - around, size + 2 * around, 0.0f);
        field.wake({first, first, first + size, first + size});
        for (std::int32_t j = 0; j < size; ++j)
            for (std::int32_t i = 0; i < size; ++i)
                field.height_row(first + j)[first + i] =
                    1e-3f * std::sin(0.3f * static_cast<float>(i)) * std::cos(0.2f * static_cast<float>(j));
        constexpr std::uint32_t steps = CalmTiles::interval;
        times.push_back(microseconds(steps, [&] { field.step(0.002f, gravity, 1); }));
    } while (seconds_since(begin) < seconds);
    std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
    return times[times.size() / 2];
}

}  // namespace frm::cli
