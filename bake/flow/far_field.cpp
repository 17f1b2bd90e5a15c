#include "bake/flow/far_field.h"

#include <algorithm>
#include <cmath>

#include "bake/flow/collision.h"

namespace frm::bake::flow {
namespace {

constexpr float outlet_restoring = 0.1f;

float equilibrium(int i, float excess, float ux, float uy, float uz) {
    const Direction& c = directions[static_cast<std::size_t>(i)];
    const float along = static_cast<float>(c.x) * ux + static_cast<float>(c.y) * uy + static_cast<float>(c.z) * uz;
    const float square = ux * ux + uy * uy + uz * uz;
    return weight(i) * (excess + (1 + excess) * (3 * along + 4.5f * along * along - 1.5f * square));
}

}  // namespace

std::array<float, direction_count> stream_populations(const std::array<float, 3>& velocity) {
    std::array<float, direction_count> f{};
    for (int i = 0; i < direction_count; ++i) {
        f[static_cast<std::size_t>(i)] = equilibrium(i, 0, velocity[0], velocity[1], velocity[2]);
    }
    return f;
}

void fill_stream(const Grid& grid, Populations& populations, const std::array<float, direction_count>& stream) {
    const std::size_t pitch = grid.pitch(), lines = static_cast<std::size_t>(grid.ny) + 2;
    for (int i = 0; i < direction_count; ++i) {
        const float value = stream[static_cast<std::size_t>(i)];
        float* const p = populations.at(i);
        p[-1] = value;
        for (std::size_t r = 0; r < grid.allocated_rows(); ++r) {
            const std::size_t line = r % lines, layer = r / lines;
            const bool beside = line == 0 || line + 1 == lines ||
                                (!grid.periodic && (layer == 0 || layer == static_cast<std::size_t>(grid.nz) + 1));
            float* const row = p + r * pitch;
            if (beside) std::fill(row, row + pitch, value);
            row[pitch - 1] = value;  // the next row's ghost ahead
        }
    }
}

void close_row(const Grid& grid, Populations& populations, std::size_t row,
               const std::array<float, direction_count>& stream, bool open) {
    const std::size_t first = grid.row(row), last = first + static_cast<std::size_t>(grid.nx) - 1;
    float excess = 0, mx = 0, my = 0, mz = 0;
    for (int i = 0; i < direction_count; ++i) {
        const Direction& c = directions[static_cast<std::size_t>(i)];
        const float f = populations.at(i)[last];
        excess += f;
        mx += static_cast<float>(c.x) * f;
        my += static_cast<float>(c.y) * f;
        mz += static_cast<float>(c.z) * f;
    }
    const float inverse = 1 / (1 + excess);
    const float ux = std::max(mx * inverse, 0.0f), uy = my * inverse, uz = mz * inverse;
    excess *= 1 - outlet_restoring;
    for (int i = 1; i < direction_count; ++i) {
        const Direction& c = directions[static_cast<std::size_t>(i)];
        if (c.x < 0) {
            populations.at(i)[last + 1] =
                open ? equilibrium(i, excess, ux, uy, uz) : stream[static_cast<std::size_t>(i)];
        }
        if (c.x > 0) populations.at(i)[first + grid.pitch() - 1] = stream[static_cast<std::size_t>(i)];
    }
}

std::vector<float> relaxation_times(const Grid& grid, double base, double sponge) {
    std::vector<float> times(grid.pitch());
    for (std::size_t x = 0; x < times.size(); ++x) {
        const double past = static_cast<double>(x) - (grid.nx - sponge);
        const double depth = sponge > 0 ? std::clamp(past / sponge, 0.0, 1.0) : 0.0;
        times[x] = static_cast<float>(base + std::max(0.0, 1 - base) * depth * depth);
    }
    return times;
}

std::array<float, direction_count> still_populations(const Turning& turning, float x, float y) {
    float ux = turning.far_x(y), uy = turning.far_y(x);
    from_middle(turning, {x, y, 0, 0}, 1, &ux, &uy);
    std::array<float, direction_count> f{};
    collided(0, ux, uy, 0, {}, [&](int i, float value) { f[static_cast<std::size_t>(i)] = value; });
    return f;
}

void fill_still(const Grid& grid, Populations& populations, const Turning& turning) {
    for (int j = -1; j <= grid.ny; ++j) {
        for (int i = -1; i <= grid.nx; ++i) {
            const bool beside = i < 0 || j < 0 || i == grid.nx || j == grid.ny;
            const auto f = still_populations(turning, static_cast<float>(i), static_cast<float>(j));
            for (int k = -1; k <= grid.nz; ++k) {
                if (!beside && k >= 0 && k < grid.nz) continue;
                // The very first ghost ahead lies in the slack before the rows: not an index of its own.
                const std::ptrdiff_t cell = static_cast<std::ptrdiff_t>(grid.index(0, j, k)) + i;
                for (int d = 0; d < direction_count; ++d) populations.at(d)[cell] = f[static_cast<std::size_t>(d)];
            }
        }
    }
}

void close_row_still(const Grid& grid, Populations& populations, std::size_t row, const Turning& turning,
                     double reach) {
    const int j = grid.row_y(row);
    const std::size_t first = grid.row(row);
    const auto hold = [&](std::size_t cell, int x, int y) {
        const auto f = still_populations(turning, static_cast<float>(x), static_cast<float>(y));
        for (int i = 0; i < direction_count; ++i) populations.at(i)[cell] = f[static_cast<std::size_t>(i)];
    };
    const double y = j - static_cast<double>(turning.axis_y), half = std::sqrt(std::max(0.0, reach * reach - y * y));
    const int from = std::clamp(static_cast<int>(std::ceil(static_cast<double>(turning.axis_x) - half)), 0, grid.nx);
    const int to =
        std::clamp(static_cast<int>(std::floor(static_cast<double>(turning.axis_x) + half)) + 1, from, grid.nx);
    for (int x = 0; x < from; ++x) hold(first + static_cast<std::size_t>(x), x, j);
    for (int x = to; x <= grid.nx; ++x) hold(first + static_cast<std::size_t>(x), x, j);
    // The last cell of a row's memory is the ghost ahead of the next row.
    hold(first + grid.pitch() - 1, -1, j + 1);
}

std::vector<float> still_relaxation_times(const Grid& grid, double base, double sponge, const Turning& turning,
                                          double reach) {
    std::vector<float> times(grid.rows() * grid.pitch());
    for (std::size_t r = 0; r < grid.rows(); ++r) {
        const int y = grid.row_y(r), z = grid.row_z(r);
        for (std::size_t x = 0; x < grid.pitch(); ++x) {
            const double dx = static_cast<double>(x) - static_cast<double>(turning.axis_x);
            const double dy = y - static_cast<double>(turning.axis_y);
            const double away = std::min({reach - std::hypot(dx, dy), z + 0.0, grid.nz - 1.0 - z});
            const double depth = sponge > 0 ? std::clamp(1 - away / sponge, 0.0, 1.0) : 0.0;
            times[r * grid.pitch() + x] = static_cast<float>(base + std::max(0.0, 1 - base) * depth * depth);
        }
    }
    return times;
}

}  // namespace frm::bake::flow
