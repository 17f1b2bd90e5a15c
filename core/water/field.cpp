#include "core/water/field.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/kernels/kernels.h"

namespace frm {
namespace {

/// Below this many cells the threads cost more than they bring (measured with `frm bench`).
constexpr std::size_t threaded_cells = std::size_t{1} << 18;

/// std::floor of a number that is small; a call to it costs more than the four samples where the machine lacks SSE4.1.
std::int32_t whole_below(float x) {
    const auto whole = static_cast<std::int32_t>(x);
    return whole - (static_cast<float>(whole) > x);
}

float bilinear(const float* data, std::int32_t nx, std::int32_t ny, const GridOrigin& o, float x, float y) {
    const std::int32_t fx = whole_below(x), fy = whole_below(y);
    std::int32_t i = o.i + fx, j = o.j + fy;
    float s = x - static_cast<float>(fx), t = y - static_cast<float>(fy);
    // Between the outermost samples and the border, the outermost sample holds.
    if (i < 0) i = 0, s = 0;
    if (j < 0) j = 0, t = 0;
    if (i > nx - 2) i = nx - 2, s = 1;
    if (j > ny - 2) j = ny - 2, t = 1;
    const float* p = data + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + i;
    const float low = p[0] + s * (p[1] - p[0]);
    const float high = p[nx] + s * (p[nx + 1] - p[nx]);
    return low + t * (high - low);
}

}  // namespace

Field::Field(const FieldDef& def, std::pmr::memory_resource* memory)
    : def_(def),
      height_(static_cast<std::size_t>(def.nx) * static_cast<std::size_t>(def.ny), 0.0f, memory),
      u_(static_cast<std::size_t>(def.nx + 1) * static_cast<std::size_t>(def.ny), 0.0f, memory),
      v_(static_cast<std::size_t>(def.nx) * static_cast<std::size_t>(def.ny + 1), 0.0f, memory) {}

float Field::stable_step(const FieldDef& def, float gravity) {
    const float speed = std::sqrt(gravity * def.depth);
    return speed > 0 ? 0.9f * 0.70710678f * def.cell / speed : 1e30f;
}

void Field::step(float dt, float gravity, std::uint32_t threads) {
    const float speed = std::sqrt(gravity * def_.depth);
    step_velocities(dt * gravity / def_.cell, def_.border == Border::absorbing ? speed / def_.depth : 0.0f, threads);
    step_heights(dt * def_.depth / def_.cell, threads);
    if (def_.border == Border::absorbing && def_.border_cells > 0) damp(dt, speed);
}

// At an open border the outermost face moves as a wave that leaves does: u = h sqrt(g / d) (Flather 1976).
void Field::step_velocities(float factor, float outflow, std::uint32_t threads) {
    const std::int32_t nx = def_.nx, ny = def_.ny;
    const Kernels& row = kernels();
    [[maybe_unused]] const bool parallel = threads > 1 && cells() >= threaded_cells;
#pragma omp parallel for schedule(static) num_threads(static_cast <int>(threads)) if (parallel)
    for (std::int32_t j = 0; j < ny; ++j) {
        const float* h = height_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx);
        float* u = u_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx + 1);
        u[0] = -outflow * h[0];
        row.wave_velocity_row(u + 1, h + 1, 1, nx - 1, factor);
        u[nx] = outflow * h[nx - 1];

        float* v = v_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx);
        if (j == 0) {
            for (std::int32_t i = 0; i < nx; ++i) v[i] = -outflow * h[i];
        } else {
            row.wave_velocity_row(v, h, nx, nx, factor);
        }
        if (j == ny - 1)
            for (std::int32_t i = 0; i < nx; ++i) v[nx + i] = outflow * h[i];
    }
}

void Field::step_heights(float factor, std::uint32_t threads) {
    const std::int32_t nx = def_.nx, ny = def_.ny;
    const Kernels& row = kernels();
    [[maybe_unused]] const bool parallel = threads > 1 && cells() >= threaded_cells;
#pragma omp parallel for schedule(static) num_threads(static_cast <int>(threads)) if (parallel)
    for (std::int32_t j = 0; j < ny; ++j) {
        float* h = height_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx);
        const float* u = u_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx + 1);
        const float* v = v_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx);
        row.wave_height_row(h, u, v, v + nx, nx, factor);
    }
}

// A layer in which height and velocity decay together (so that it does not reflect), the faster the nearer to the
// border: rate r (1 - x / width)^2 with r so large that a wave that crosses it twice keeps exp(-5).
void Field::damp(float dt, float speed) {
    const std::int32_t nx = def_.nx, ny = def_.ny, width = def_.border_cells;
    const float rate = 7.5f * speed / (static_cast<float>(width) * def_.cell);
    const auto keep = [&](float distance) {
        const float x = 1.0f - distance / static_cast<float>(width);
        return x > 0 ? 1.0f / (1.0f + dt * rate * x * x) : 1.0f;
    };
    const auto damp_rows = [&](float* data, std::int32_t columns, std::int32_t rows, float offset) {
        for (std::int32_t k = 0; k < width; ++k) {
            const float s = keep(static_cast<float>(k) + offset);
            float* low = data + static_cast<std::size_t>(k) * static_cast<std::size_t>(columns);
            float* high = data + static_cast<std::size_t>(rows - 1 - k) * static_cast<std::size_t>(columns);
            for (std::int32_t i = 0; i < columns; ++i) low[i] *= s;
            for (std::int32_t i = 0; i < columns; ++i) high[i] *= s;
        }
    };
    const auto damp_columns = [&](float* data, std::int32_t columns, std::int32_t rows, float offset) {
        float s[64];
        for (std::int32_t k = 0; k < width; ++k) s[k] = keep(static_cast<float>(k) + offset);
        for (std::int32_t j = 0; j < rows; ++j) {
            float* row = data + static_cast<std::size_t>(j) * static_cast<std::size_t>(columns);
            for (std::int32_t k = 0; k < width; ++k) row[k] *= s[k];
            for (std::int32_t k = 0; k < width; ++k) row[columns - 1 - k] *= s[k];
        }
    };
    damp_rows(height_.data(), nx, ny, 0.5f);
    damp_rows(u_.data(), nx + 1, ny, 0.5f);
    damp_rows(v_.data(), nx, ny + 1, 0.0f);
    damp_columns(height_.data(), nx, ny, 0.5f);
    damp_columns(u_.data(), nx + 1, ny, 0.0f);
    damp_columns(v_.data(), nx, ny + 1, 0.5f);
}

void Field::push(const float* pressure, std::int32_t columns, std::int32_t rows, const Rect& where, std::int32_t di,
                 std::int32_t dj, float factor) {
    const std::int32_t nx = def_.nx;
    // The gradient reaches one face beyond the cells; faces of either array's outer border are not pushed.
    const Rect r = Rect{where.i0, where.j0, where.i1 + 1, where.j1 + 1}
                       .clipped(columns, rows)
                       .moved(di, dj)
                       .clipped(nx, def_.ny)
                       .moved(-di, -dj);
    if (r.empty()) return;
    const float f = factor / def_.cell;
    const std::int32_t first_i = std::max({r.i0, 1, 1 - di}), first_j = std::max(1, 1 - dj);
    for (std::int32_t j = r.j0; j < r.j1; ++j) {
        const float* p = pressure + static_cast<std::ptrdiff_t>(j) * columns;
        float* u = u_.data() + static_cast<std::ptrdiff_t>(j + dj) * (nx + 1) + di;
        float* v = v_.data() + static_cast<std::ptrdiff_t>(j + dj) * nx + di;
        for (std::int32_t i = first_i; i < r.i1; ++i) u[i] += f * (p[i] - p[i - 1]);
        if (j < first_j) continue;
        for (std::int32_t i = r.i0; i < r.i1; ++i) v[i] += f * (p[i] - p[i - columns]);
    }
}

float Field::height_at(const GridOrigin& o, float x, float y) const {
    const float gx = o.x + x, gy = o.y + y;
    const float px = static_cast<float>(o.i) + gx, py = static_cast<float>(o.j) + gy;
    if (!(px >= 0 && py >= 0 && px <= static_cast<float>(def_.nx) && py <= static_cast<float>(def_.ny))) return 0;
    return bilinear(height_.data(), def_.nx, def_.ny, o, gx - 0.5f, gy - 0.5f);
}

void Field::velocity_at(const GridOrigin& o, float x, float y, float& u, float& v) const {
    const float gx = o.x + x, gy = o.y + y;
    const float px = static_cast<float>(o.i) + gx, py = static_cast<float>(o.j) + gy;
    u = v = 0;
    if (!(px >= 0 && py >= 0 && px <= static_cast<float>(def_.nx) && py <= static_cast<float>(def_.ny))) return;
    u = bilinear(u_.data(), def_.nx + 1, def_.ny, o, gx, gy - 0.5f);
    v = bilinear(v_.data(), def_.nx, def_.ny + 1, o, gx - 0.5f, gy);
}

void Field::calm() {
    std::memset(height_.data(), 0, height_.size() * sizeof(float));
    std::memset(u_.data(), 0, u_.size() * sizeof(float));
    std::memset(v_.data(), 0, v_.size() * sizeof(float));
}

void Field::shift(std::int32_t di, std::int32_t dj) {
    shift_array(height_.data(), def_.nx, def_.ny, di, dj);
    shift_array(u_.data(), def_.nx + 1, def_.ny, di, dj);
    shift_array(v_.data(), def_.nx, def_.ny + 1, di, dj);
}

void Field::hash(StateHash& hash) const {
    hash.words(height_.data(), height_.size());
    hash.words(u_.data(), u_.size());
    hash.words(v_.data(), v_.size());
}

void shift_array(float* data, std::int32_t nx, std::int32_t ny, std::int32_t di, std::int32_t dj) {
    if (di == 0 && dj == 0) return;
    const std::int32_t keep = nx - (di < 0 ? -di : di);
    const auto row = [&](std::int32_t j) { return data + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx); };
    for (std::int32_t n = 0; n < ny; ++n) {
        const std::int32_t j = dj >= 0 ? n : ny - 1 - n;  // in the order that reads a row before it is written
        const std::int32_t from = j + dj;
        if (from < 0 || from >= ny || keep <= 0) {
            std::memset(row(j), 0, static_cast<std::size_t>(nx) * sizeof(float));
            continue;
        }
        float* out = row(j);
        const float* in = row(from);
        std::memmove(out + (di < 0 ? -di : 0), in + (di > 0 ? di : 0), static_cast<std::size_t>(keep) * sizeof(float));
        if (di > 0) std::memset(out + keep, 0, static_cast<std::size_t>(di) * sizeof(float));
        if (di < 0) std::memset(out, 0, static_cast<std::size_t>(-di) * sizeof(float));
    }
}

}  // namespace frm
