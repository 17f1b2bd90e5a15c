#include "core/water/field.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/kernels/kernels.h"

namespace frm {
namespace {

/// std::floor of a number that is small; a call to it costs more than the four samples where the machine lacks SSE4.1.
std::int32_t whole_below(float x) {
    const auto whole = static_cast<std::int32_t>(x);
    return whole - (static_cast<float>(whole) > x);
}

float bilinear(const float* data, std::int32_t nx, std::int32_t ny, std::ptrdiff_t stride, const GridOrigin& o, float x,
               float y) {
    const std::int32_t fx = whole_below(x), fy = whole_below(y);
    std::int32_t i = o.i + fx, j = o.j + fy;
    float s = x - static_cast<float>(fx), t = y - static_cast<float>(fy);
    // Between the outermost samples and the border, the outermost sample holds.
    if (i < 0) i = 0, s = 0;
    if (j < 0) j = 0, t = 0;
    if (i > nx - 2) i = nx - 2, s = 1;
    if (j > ny - 2) j = ny - 2, t = 1;
    const float* p = data + j * stride + i;
    const float low = p[0] + s * (p[1] - p[0]);
    const float high = p[stride] + s * (p[stride + 1] - p[stride]);
    return low + t * (high - low);
}

constexpr std::int32_t vector = 16;     ///< floats in 64 bytes
constexpr std::int32_t keep_room = 64;  ///< the widest layer

/// Two cells beyond the last face, and a vector before the first; rows a page apart would all want the same cache sets.
std::ptrdiff_t stride_for(std::int32_t nx) {
    const std::ptrdiff_t stride = vector + (nx + 2 + vector - 1) / vector * vector;
    return stride % 1024 == 0 ? stride + vector : stride;
}

/// Floats of one array with its rows -1 and ny + 1, so much that the three arrays begin a third of a page apart.
std::ptrdiff_t plane_for(std::int32_t ny, std::ptrdiff_t stride) {
    const std::ptrdiff_t page = 1024, third = 336, size = stride * (ny + 3);
    return (size - third + page - 1) / page * page + third;
}

}  // namespace

Field::Field(const FieldDef& def, std::pmr::memory_resource* memory)
    : def_(def),
      stride_(stride_for(def.nx)),
      memory_(static_cast<std::size_t>(3 * plane_for(def.ny, stride_) + 2 * vector), 0.0f, memory),
      keep_(static_cast<std::size_t>(2 * keep_room + 2 * (2 * keep_room + 2 * vector)), 1.0f, memory),
      tiles_(def.nx, def.ny, def.skip_calm_tiles, memory) {
    const std::ptrdiff_t plane = plane_for(def.ny, stride_);
    height_ = memory_.data() + stride_ + vector;
    u_ = height_ + plane;
    v_ = u_ + plane;

    // Whole vectors that hold the layer at the left end, and at the right end with the last face.
    const std::int32_t width = def.border_cells;
    damp_.left = (width + vector - 1) / vector * vector;
    damp_.right_at = (def.nx - width) / vector * vector;
    damp_.right = (def.nx + vector) / vector * vector - damp_.right_at;
    ends_ = keep_.data() + 2 * keep_room;
    damp_.cells_left = ends_;
    damp_.faces_left = ends_ + keep_room;
    damp_.cells_right = damp_.faces_left + keep_room;
    damp_.faces_right = damp_.cells_right + keep_room + 2 * vector;
}

float Field::stable_step(const FieldDef& def, float gravity) {
    const float speed = std::sqrt(gravity * def.depth);
    const float courant = def.order == 4 ? 0.4f : 0.9f * 0.70710678f;
    return speed > 0 ? courant * def.cell / speed : 1e30f;
}

float Field::height_at(const GridOrigin& o, float x, float y) const {
    const float gx = o.x + x, gy = o.y + y;
    const float px = static_cast<float>(o.i) + gx, py = static_cast<float>(o.j) + gy;
    if (!(px >= 0 && py >= 0 && px <= static_cast<float>(def_.nx) && py <= static_cast<float>(def_.ny))) return 0;
    return std::max(level() + bilinear(height_, def_.nx, def_.ny, stride_, o, gx - 0.5f, gy - 0.5f), -def_.depth);
}

void Field::velocity_at(const GridOrigin& o, float x, float y, float& u, float& v) const {
    const float gx = o.x + x, gy = o.y + y;
    const float px = static_cast<float>(o.i) + gx, py = static_cast<float>(o.j) + gy;
    u = v = 0;
    if (!(px >= 0 && py >= 0 && px <= static_cast<float>(def_.nx) && py <= static_cast<float>(def_.ny))) return;
    u = bilinear(u_, def_.nx + 1, def_.ny, stride_, o, gx, gy - 0.5f);
    v = bilinear(v_, def_.nx, def_.ny + 1, stride_, o, gx - 0.5f, gy);
}

void Field::pull_at(const GridOrigin& o, float x, float y, float pull, float& u, float& v) const {
    const std::int32_t fx = whole_below(o.x + x), fy = whole_below(o.y + y);
    u = v = 0;
    if (o.i + fx < 0 || o.j + fy < 0 || o.i + fx >= def_.nx || o.j + fy >= def_.ny) return;
    const std::int32_t i = std::clamp(o.i + fx, 1, def_.nx - 2), j = std::clamp(o.j + fy, 1, def_.ny - 2);
    // The slopes at the faces around, as those of velocity_at without its interpolation across them.
    const float s = o.x + x - static_cast<float>(fx), t = o.y + y - static_cast<float>(fy);
    const float *below = height_row(j - 1) + i, *h = height_row(j) + i, *above = height_row(j + 1) + i;
    u = -pull * ((1 - s) * (h[0] - h[-1]) + s * (h[1] - h[0]));
    v = -pull * ((1 - t) * (h[0] - below[0]) + t * (above[0] - h[0]));
}

void Field::heights_ahead(const Rect& cells, float rise, float bend, float* out) const {
    const Rect r = cells.clipped(def_.nx, def_.ny);
    const auto row = kernels().heights_ahead_row;
    for (std::int32_t j = r.j0; j < r.j1; ++j) {
        const float* const h = height_row(j);
        const float *const u = velocity_x_row(j), *const v = velocity_y_row(j), *const above = velocity_y_row(j + 1);
        float* const to = out + j * stride_;
        // No slope at a border.
        row(to + r.i0, h + r.i0, height_row(std::max(j - 1, 0)) + r.i0, height_row(std::min(j + 1, def_.ny - 1)) + r.i0,
            u + r.i0, v + r.i0, above + r.i0, r.i1 - r.i0, rise, bend);
        for (const std::int32_t i : {0, def_.nx - 1})
            if (i >= r.i0 && i < r.i1) to[i] = h[i] - rise * ((u[i + 1] - u[i]) + (above[i] - v[i]));
    }
}

bool Field::mean_heights(const Rect& cells, float dt, float gravity, std::uint32_t steps, float later, Room& room,
                         float* out) const {
    // What happens further away than a cell a step does not get here in time; the faces around stay as they are.
    const std::uint32_t looks = steps + (later > 0 ? 1 : 0);
    const auto reach = static_cast<std::int32_t>(std::min(looks, 1u << 16));
    const Rect wanted = cells.clipped(def_.nx, def_.ny);
    if (wanted.empty()) return true;
    const Rect r =
        Rect{wanted.i0 - reach, wanted.j0 - reach, wanted.i1 + reach, wanted.j1 + reach}.clipped(def_.nx, def_.ny);
    const std::int32_t nx = r.i1 - r.i0, ny = r.j1 - r.j0;
    const std::ptrdiff_t stride = nx + 1;
    if (std::int64_t{nx + 1} * (ny + 1) > Room::cells) return false;
    const auto row = [&](std::pmr::vector<float>& of, std::int32_t j) { return of.data() + j * stride; };
    for (std::int32_t j = 0; j <= ny; ++j) {
        std::copy_n(velocity_y_row(r.j0 + j) + r.i0, nx, row(room.v, j));
        if (j == ny) break;
        std::copy_n(velocity_x_row(r.j0 + j) + r.i0, nx + 1, row(room.u, j));
        std::copy_n(height_row(r.j0 + j) + r.i0, nx, row(room.height, j));
    }
    const std::int32_t width = wanted.i1 - wanted.i0, left = wanted.i0 - r.i0;
    const float slope = dt * gravity / def_.cell, divergence = dt * def_.depth / def_.cell;
    // Between two steps in a straight line: of the first less than of the others, and of one more the rest.
    for (std::int32_t j = wanted.j0; j < wanted.j1; ++j) {
        const float* const h = height_row(j) + wanted.i0;
        float* const sum = out + j * stride_ + wanted.i0;
        for (std::int32_t i = 0; i < width; ++i) sum[i] = (1 - later) * h[i];
    }
    for (std::uint32_t n = 1; n < looks; ++n) {
        for (std::int32_t j = 0; j < ny; ++j) {
            const float *const h = row(room.height, j), *const below = h - stride;
            float *const u = row(room.u, j), *const v = row(room.v, j);
            for (std::int32_t i = 1; i < nx; ++i) u[i] -= slope * (h[i] - h[i - 1]);
            if (j == 0) continue;
            for (std::int32_t i = 0; i < nx; ++i) v[i] -= slope * (h[i] - below[i]);
        }
        for (std::int32_t j = 0; j < ny; ++j) {
            float* const h = row(room.height, j);
            const float *const u = row(room.u, j), *const v = row(room.v, j), *const above = v + stride;
            for (std::int32_t i = 0; i < nx; ++i) h[i] -= divergence * ((u[i + 1] - u[i]) + (above[i] - v[i]));
        }
        const float weight = n < steps ? 1.0f : later;
        for (std::int32_t j = wanted.j0; j < wanted.j1; ++j) {
            float* const sum = out + j * stride_ + wanted.i0;
            const float* const h = row(room.height, j - r.j0) + left;
            for (std::int32_t i = 0; i < width; ++i) sum[i] += weight * h[i];
        }
    }
    const float share = 1 / static_cast<float>(steps);
    for (std::int32_t j = wanted.j0; j < wanted.j1; ++j) {
        float* const sum = out + j * stride_ + wanted.i0;
        for (std::int32_t i = 0; i < width; ++i) sum[i] *= share;
    }
    return true;
}

void Field::raise(double volume) {
    if (def_.border == Border::reflecting) level_ += volume / static_cast<double>(cells());
}

void Field::copy_heights(float* out) const {
    const float up = level();
    for (std::int32_t j = 0; j < def_.ny; ++j, out += def_.nx) {
        const float* const h = height_row(j);
        for (std::int32_t i = 0; i < def_.nx; ++i) out[i] = h[i] + up;
    }
}

void Field::set_heights(const float* height) {
    calm();
    wake({0, 0, def_.nx, def_.ny});
    const auto nx = static_cast<std::size_t>(def_.nx);
    double sum = 0;
    for (std::int32_t j = 0; j < def_.ny; ++j, height += nx) {
        std::memcpy(height_row(j), height, nx * sizeof(float));
        for (std::size_t i = 0; i < nx; ++i) sum += static_cast<double>(height[i]);
    }
    if (def_.border == Border::reflecting) mean_set_ = sum / static_cast<double>(cells());
}

void Field::start_from_rest(float dt, float gravity) {
    const float half = 0.5f * dt * gravity / def_.cell;
    for (std::int32_t j = 0; j < def_.ny; ++j) {
        const float *h = height_row(j), *below = height_row(std::max(j - 1, 0));
        float *u = velocity_x_row(j), *v = velocity_y_row(j);
        for (std::int32_t i = 1; i < def_.nx; ++i) u[i] = half * (h[i] - h[i - 1]);
        for (std::int32_t i = 0; i < def_.nx; ++i) v[i] = half * (h[i] - below[i]);
    }
}

void Field::calm() {
    std::fill(memory_.begin(), memory_.end(), 0.0f);
    high_ = false;
    finite_ = true;
    level_ = mean_set_ = 0;
    tiles_.sleep_all();
}

void Field::shift(std::int32_t di, std::int32_t dj) {
    wake({0, 0, def_.nx, def_.ny});
    shift_array(height_, def_.nx, def_.ny, stride_, di, dj);
    shift_array(u_, def_.nx + 1, def_.ny, stride_, di, dj);
    shift_array(v_, def_.nx, def_.ny + 1, stride_, di, dj);
}

void Field::hash(StateHash& hash) const {
    const auto nx = static_cast<std::size_t>(def_.nx);
    for (std::int32_t j = 0; j < def_.ny; ++j) hash.numbers(height_row(j), nx);
    for (std::int32_t j = 0; j < def_.ny; ++j) hash.numbers(velocity_x_row(j), nx + 1);
    for (std::int32_t j = 0; j <= def_.ny; ++j) hash.numbers(velocity_y_row(j), nx);
    hash.value(level_);
    tiles_.hash(hash);
}

void shift_array(float* data, std::int32_t nx, std::int32_t ny, std::ptrdiff_t stride, std::int32_t di,
                 std::int32_t dj) {
    if (di == 0 && dj == 0) return;
    const std::int32_t keep = nx - (di < 0 ? -di : di);
    const auto row = [&](std::int32_t j) { return data + j * stride; };
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
