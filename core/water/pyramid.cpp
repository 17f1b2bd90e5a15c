#include "core/water/pyramid.h"

#include <algorithm>
#include <utility>

#include "core/kernels/kernels.h"

namespace frm {
namespace {

/// Smooth in the position, and the weights add up to one.
void spline_weights(float offset, float w[3]) {
    w[0] = 0.5f * (0.5f - offset) * (0.5f - offset);
    w[1] = 0.75f - offset * offset;
    w[2] = 0.5f * (0.5f + offset) * (0.5f + offset);
}

}  // namespace

Pyramid::Pyramid(std::int32_t size, int levels, std::pmr::memory_resource* memory)
    : levels_(levels),
      grid_{{Grid(memory), Grid(memory), Grid(memory), Grid(memory), Grid(memory), Grid(memory), Grid(memory)}} {
    for (int k = 0; k < levels_; ++k) {
        Grid& grid = grid_[static_cast<std::size_t>(k)];
        grid.size = size >> k;
        // Coarse rows go on to whole eights and have an empty one between them, for gather(); all begin on cache lines.
        grid.stride = k == 0 ? grid.size : ((grid.size + 7) / 8 * 8 + 8 + 15) / 16 * 16;
        grid.value.assign(static_cast<std::size_t>(grid.size * grid.stride), 0.0f);
    }
}

void Pyramid::clear() {
    for (Grid& grid : grid_) {
        for (std::int32_t j = grid.wet.j0; j < grid.wet.j1; ++j) {
            float* const row = grid.row(j);
            std::fill(row + grid.wet.i0, row + grid.wet.i1, 0.0f);
        }
        grid.wet = {};
    }
}

// The outermost cells stay empty, so that gather() finds a neighbour of everything that is not zero.
bool Pyramid::add(int level, float x, float y, float amount) {
    Grid& grid = grid_[static_cast<std::size_t>(level)];
    const auto end = static_cast<float>(grid.size - 2);
    if (!(x >= 2.0f && y >= 2.0f && x < end && y < end)) return false;
    const auto i = static_cast<std::int32_t>(x), j = static_cast<std::int32_t>(y);
    float wx[3], wy[3];
    spline_weights(x - static_cast<float>(i) - 0.5f, wx);
    spline_weights(y - static_cast<float>(j) - 0.5f, wy);
    float* row = grid.row(j - 1) + (i - 1);
    for (int q = 0; q < 3; ++q, row += grid.stride) {
        const float part = amount * wy[q];
        row[0] += part * wx[0];
        row[1] += part * wx[1];
        row[2] += part * wx[2];
    }
    grid.wet.include({i - 1, j - 1, i + 2, j + 2});
    return true;
}

bool Pyramid::add_wide(float x, float y, float width, float amount) {
    int level = 0;
    while (level < levels_ - 2 && width >= width_of[level + 1]) ++level;
    const auto cell = static_cast<float>(1 << level);
    const float below = width_of[level] * width_of[level], above = width_of[level + 1] * width_of[level + 1];
    const float share = std::clamp((width * width - below) / (above - below), 0.0f, 1.0f);  // of the next level
    const float scale = 1.0f / cell, each = amount * scale * scale;
    bool laid = true;
    if (share < 1) laid = add(level, x * scale, y * scale, each * (1.0f - share));
    if (share > 0) laid = add(level + 1, x * (0.5f * scale), y * (0.5f * scale), 0.25f * each * share) && laid;
    return laid;
}

void Pyramid::gather() {
    const auto refine = kernels().refine;
    for (auto k = static_cast<std::size_t>(levels_ - 1); k > 0; --k) {
        const Grid& from = grid_[k];
        if (from.wet.empty()) continue;
        Grid& to = grid_[k - 1];
        const Rect& w = from.wet;
        const std::int32_t begin = (w.i0 - 1) / 8 * 8, end = (w.i1 + 8) / 8 * 8;
        refine(to.row(2 * w.j0) + 2 * begin, to.stride, from.row(w.j0) + begin, from.stride, w.j1 - w.j0,
               (end - begin) / 8);
        to.wet.include({2 * w.i0 - 1, 2 * w.j0 - 1, 2 * w.i1 + 1, 2 * w.j1 + 1});
    }
    // Rows of whole vectors for all that goes through them; what is added is zero.
    Rect& wet = grid_[0].wet;
    if (wet.empty()) return;
    wet.i0 = wet.i0 / 16 * 16;
    wet.i1 = (wet.i1 + 15) / 16 * 16;
}

void Pyramid::swap_finest(AlignedFloats& values, Rect& wet) {
    std::swap(grid_[0].value, values);
    std::swap(grid_[0].wet, wet);
}

}  // namespace frm
