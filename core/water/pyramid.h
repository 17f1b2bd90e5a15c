// Grids over one window of the water, each of twice the cell of the one before: what is narrow is laid on the fine ones,
// what is wide on the coarse ones, and gather() adds all of it up on the finest.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory_resource>

#include "core/water/aligned_floats.h"
#include "core/water/field.h"

namespace frm {

class Pyramid {
public:
    static constexpr int fewest_levels = 4, most_levels = 7;
    /// As wide as a Gaussian of this many cells of the finest grid is what a spline of each level adds up to there. Its
    /// variance is 1/4 of its own cells squared, and 3/4 of the finer ones' at each gathering: sqrt(1/2 4^k - 1/4).
    static constexpr float width_of[most_levels] = {0.5f,       1.3228757f, 2.7838822f, 5.6347138f,
                                                    11.302654f, 22.621892f, 45.252072f};
    /// The same for all but the finest, nearly, in cells of the level.
    static constexpr float width_of_spline = 0.7f;

    /// `size`: cells along a side of the finest grid, a multiple of sixteen and of two of the coarsest cells.
    Pyramid(std::int32_t size, int levels, std::pmr::memory_resource* memory);

    /// Everything is zero again. Costs what was laid.
    void clear();
    /// A quadratic B-spline around (x, y), in cells of the level, whose values add up to `amount`. False, and nothing
    /// laid, at the window's edge and beyond.
    bool add(int level, float x, float y, float amount);
    /// The same on the two levels between whose widths `width` (cells of the finest grid) lies, so that the variance is
    /// that of such a Gaussian, whose values on the finest grid add up to `amount`; at most widest() wide.
    bool add_wide(float x, float y, float width, float amount);
    float widest() const { return width_of[levels_ - 1]; }
    int levels() const { return levels_; }
    /// Adds what was laid on coarse grids to the finest.
    void gather();

    std::int32_t size() const { return grid_[0].size; }
    /// Cells of the finest grid with something in them; once gathered, in whole sixteens of columns.
    const Rect& wet() const { return grid_[0].wet; }
    void include(const Rect& r) { grid_[0].wet.include(r); }
    float* data() { return grid_[0].value.data(); }
    const float* data() const { return grid_[0].value.data(); }
    float* row(std::int32_t j) { return data() + static_cast<std::ptrdiff_t>(j) * size(); }
    const float* row(std::int32_t j) const { return data() + static_cast<std::ptrdiff_t>(j) * size(); }
    /// Changes the finest grid for another of the same size.
    void swap_finest(AlignedFloats& values, Rect& wet);

private:
    struct Grid {
        explicit Grid(std::pmr::memory_resource* memory) : value(memory) {}
        float* row(std::int32_t j) { return value.data() + j * stride; }
        const float* row(std::int32_t j) const { return value.data() + j * stride; }

        AlignedFloats value;
        std::int32_t size = 0;
        std::ptrdiff_t stride = 0;
        Rect wet;
    };
    int levels_;
    std::array<Grid, most_levels> grid_;  ///< those beyond levels_ are empty
};

}  // namespace frm
