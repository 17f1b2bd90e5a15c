// Grids over one window of the water, each of twice the cell of the one before: what is narrow is laid on the fine ones,
// what is wide on the coarse ones, and gather() adds all of it up on the finest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "core/water/field.h"

namespace frm {

class Pyramid {
public:
    static constexpr int levels = 4;
    /// Adds up to a spline on the finest grid as wide as a Gaussian of this many cells of its level: 0.5 of its own, and
    /// 1/4, 1/16, ... from each gathering.
    static constexpr float width_of_spline = 0.58f;

    /// `size`: cells along a side of the finest grid, a multiple of 2^(levels - 1).
    Pyramid(std::int32_t size, std::pmr::memory_resource* memory);

    /// Everything is zero again. Costs what was laid.
    void clear();
    /// A quadratic B-spline around (x, y), in cells of the level, whose values add up to `amount`. False, and nothing
    /// laid, at the window's edge and beyond.
    bool add(int level, float x, float y, float amount);
    /// The same, level by level, for a Gaussian `width` cells of the finest grid wide (between the levels in a straight
    /// line), whose values on the finest grid add up to `amount`; at most widest() wide.
    bool add_wide(float x, float y, float width, float amount);
    static constexpr float widest() { return width_of_spline * static_cast<float>(1 << (levels - 1)); }
    /// Adds what was laid on coarse grids to the finest.
    void gather();

    std::int32_t size() const { return grid_[0].size; }
    const Rect& wet() const { return grid_[0].wet; }  ///< cells of the finest grid with something in them
    void include(const Rect& r) { grid_[0].wet.include(r); }
    float* data() { return grid_[0].value.data(); }
    const float* data() const { return grid_[0].value.data(); }
    float* row(std::int32_t j) { return data() + static_cast<std::ptrdiff_t>(j) * size(); }
    const float* row(std::int32_t j) const { return data() + static_cast<std::ptrdiff_t>(j) * size(); }
    /// Changes the finest grid for another of the same size.
    void swap_finest(std::pmr::vector<float>& values, Rect& wet);

private:
    struct Grid {
        std::pmr::vector<float> value;
        std::int32_t size = 0;
        Rect wet;
    };
    std::array<Grid, levels> grid_;
};

}  // namespace frm
