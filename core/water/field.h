// One height field of shallow water and how it steps (Eqs. 7 and 8): heights at cell centres, velocities on cell faces.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "core/kernels/kernels.h"
#include "core/math/hash.h"
#include "core/water/aligned_floats.h"
#include "core/water/calm_tiles.h"
#include "core/water/rect.h"

namespace frm {

/// A point of the grid: cell (i, j) plus an offset in cells that may be larger than one. Kept apart so that the offset
/// is a small float however far from the origin the body is.
struct GridOrigin {
    std::int32_t i = 0, j = 0;
    float x = 0, y = 0;
};

enum class Border { absorbing, reflecting };

struct FieldDef {
    std::int32_t nx = 0, ny = 0;
    float cell = 0;   ///< m
    float depth = 0;  ///< m
    Border border = Border::absorbing;
    std::int32_t border_cells = 0;  ///< of the absorbing layer; at most 64
    std::int32_t order = 2;         ///< of the differences in space: 2 or 4
    bool skip_calm_tiles = true;    ///< tiles in which nothing is above `calm` rest at zero
    float calm = 0;                 ///< m; 0: a millionth of the depth, or of 20 cells where that is less
};

/// A pressure on the surface (Eq. 10): an array of `columns` by `rows` cells, not zero within `where`, whose cell
/// (0, 0) lies on cell (di, dj) of the field. Each step adds factor * its gradient to the velocities; factor = dt / density.
struct Push {
    const float* pressure = nullptr;
    std::int32_t columns = 0, rows = 0;
    Rect where;
    std::int32_t di = 0, dj = 0;
    float factor = 0;
};

/// Rows are aligned to 64 bytes and padded; what lies between a row's end and the next one's begin stays zero.
class Field {
public:
    Field(const FieldDef& def, std::pmr::memory_resource* memory);
    Field(const Field&) = delete;
    Field& operator=(const Field&) = delete;

    const FieldDef& def() const { return def_; }
    std::size_t cells() const { return static_cast<std::size_t>(def_.nx) * static_cast<std::size_t>(def_.ny); }
    /// Largest dt of one step. Second order: nine tenths of the stable one (Courant number 1 / sqrt(2) in two
    /// dimensions). Fourth order is stable up to 0.606 but exact to 0.1 % only up to 0.4, where the step in time is
    /// what is left of the phase error.
    static float stable_step(const FieldDef& def, float gravity);

    /// Leapfrog steps: velocities by the slope (Eq. 7) and the pushes, then heights by the divergence (Eq. 8). No
    /// numerical damping. Several steps go through the rows together, so that a row stays in the cache for all of
    /// them; the bits are those of one after the other, with any number of threads.
    void advance(float dt, float gravity, std::uint32_t steps, const Push* pushes, std::size_t push_count,
                 std::uint32_t threads);
    void step(float dt, float gravity, std::uint32_t threads) { advance(dt, gravity, 1, nullptr, 0, threads); }

    /// Of the heights that were set last, in a closed basin, where it stays; else 0.
    double mean_height_set() const { return mean_set_; }

    /// A push of the velocities, at once.
    void push(const Push& push);

    /// Bilinear, no lower than the bed; zero outside.
    float height_at(const GridOrigin& origin, float x, float y) const;
    void velocity_at(const GridOrigin& origin, float x, float y, float& u, float& v) const;
    /// What the velocity there goes on by (Eq. 7), over a time in which each m of slope a cell adds `pull` m/s.
    void pull_at(const GridOrigin& origin, float x, float y, float pull, float& u, float& v) const;
    /// The heights of some cells a time t later (Eq. 8, to second order), into an array with rows as far apart as these:
    /// `rise` = t * depth / cell; `bend` = (t + step) t / 2 * gravity * depth / cell^2, because the velocities are those of
    /// half a step ago.
    void heights_ahead(const Rect& cells, float rise, float bend, float* out) const;

    /// The mean of some cells' heights over the beginnings of the next `steps` steps of `dt`, or `later` of a step after
    /// each (0 to 1), without pushes; as heights_ahead. False, and nothing done, where that takes more than `room` can hold.
    struct Room {
        static constexpr std::int64_t cells = 256 * 256;  ///< at most; water of fewer has room for all of them
        Room(const FieldDef& def, std::pmr::memory_resource* memory)
            : height(count(def), 0, memory), u(count(def), 0, memory), v(count(def), 0, memory) {}
        static std::size_t count(const FieldDef& def) {
            return static_cast<std::size_t>(std::min(cells, (std::int64_t{def.nx} + 1) * (def.ny + 1)));
        }
        std::pmr::vector<float> height, u, v;
    };
    bool mean_heights(const Rect& cells, float dt, float gravity, std::uint32_t steps, float later, Room& room,
                      float* out) const;

    /// Floats from one row to the next, in each of the arrays.
    std::ptrdiff_t stride() const { return stride_; }
    float* height_row(std::int32_t j) { return height_ + j * stride_; }
    const float* height_row(std::int32_t j) const { return height_ + j * stride_; }
    /// nx + 1 faces; face i lies between cells i - 1 and i.
    float* velocity_x_row(std::int32_t j) { return u_ + j * stride_; }
    const float* velocity_x_row(std::int32_t j) const { return u_ + j * stride_; }
    /// ny + 1 rows; face j lies between cells j - 1 and j.
    float* velocity_y_row(std::int32_t j) { return v_ + j * stride_; }
    const float* velocity_y_row(std::int32_t j) const { return v_ + j * stride_; }

    /// To be told before anything is written into cells or their faces through the rows above.
    void wake(const Rect& cells) { tiles_.wake(cells); }
    /// Somewhere the water stands higher than it is deep: looked at every eight steps.
    bool has_high_waves() const { return high_; }
    /// As looked at then.
    bool is_finite() const { return finite_; }
    /// All is at rest in these cells.
    bool rests(const Rect& cells) const { return tiles_.rest(cells); }
    /// Cells that a step goes through.
    std::size_t active_cells() const { return tiles_.active_cells(); }
    /// From how many active cells on steps go through the rows together: for tests and benchmarks.
    void go_together_from(std::size_t active_cells) { together_from_ = active_cells; }
    /// Lays a volume, in cells times metres, evenly over all of a closed basin: its calm level rises. Behind an open
    /// border there is more water than that, and nothing rises.
    void raise(double volume);
    /// Of the basin's calm surface, above where it was: to be added to the rows' heights.
    float level() const { return static_cast<float>(level_); }

    /// All heights, with the level, as they are stepped: also lower than the bed. Into an array of nx by ny.
    void copy_heights(float* out) const;
    /// Calm but for these heights.
    void set_heights(const float* height);
    /// Before the first step of `dt` after set_heights: water that is at rest now had velocities half a step ago.
    void start_from_rest(float dt, float gravity);
    void calm();
    /// Moves the window over the water: what was at cell (i + di, j + dj) is at (i, j) afterwards; new cells are calm.
    void shift(std::int32_t di, std::int32_t dj);
    void hash(StateHash& hash) const;

private:
    friend class WaveStep;

    void look_for_calm(float gravity);
    void look_for_high_waves(std::uint32_t steps);

    FieldDef def_;
    std::ptrdiff_t stride_;
    AlignedFloats memory_;
    float *height_, *u_, *v_;  ///< row 0, column 0; v_ also has rows -1 and ny + 1
    /// What the absorbing layer keeps in a step: of cells and of faces, from the border inwards; then damp_'s.
    AlignedFloats keep_;
    WaveDamp damp_{};
    float* ends_;          ///< where damp_ points to, to be filled
    float keeps_for_ = 0;  ///< the dt of keep_ times the waves' speed, m
    CalmTiles tiles_;
    std::size_t together_from_ = std::size_t{1} << 21;
    double level_ = 0, mean_set_ = 0;
    std::uint32_t steps_unseen_ = 0;
    bool high_ = false, finite_ = true;
};

/// Moves the contents of an nx by ny array by whole cells, zero where nothing was; `stride` floats a row.
void shift_array(float* data, std::int32_t nx, std::int32_t ny, std::ptrdiff_t stride, std::int32_t di,
                 std::int32_t dj);

}  // namespace frm
