// One height field of shallow water and how it steps (Eqs. 7 and 8): heights at cell centres, velocities on cell faces.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "core/math/hash.h"

namespace frm {

/// Cells i0 <= i < i1, j0 <= j < j1.
struct Rect {
    std::int32_t i0 = 0, j0 = 0, i1 = 0, j1 = 0;

    bool empty() const { return i0 >= i1 || j0 >= j1; }
    void include(const Rect& o) {
        if (o.empty()) return;
        if (empty()) {
            *this = o;
            return;
        }
        if (o.i0 < i0) i0 = o.i0;
        if (o.j0 < j0) j0 = o.j0;
        if (o.i1 > i1) i1 = o.i1;
        if (o.j1 > j1) j1 = o.j1;
    }
    Rect clipped(std::int32_t nx, std::int32_t ny) const {
        return {i0 < 0 ? 0 : i0, j0 < 0 ? 0 : j0, i1 > nx ? nx : i1, j1 > ny ? ny : j1};
    }
    Rect moved(std::int32_t di, std::int32_t dj) const { return {i0 + di, j0 + dj, i1 + di, j1 + dj}; }
};

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
    std::int32_t border_cells = 0;
    std::int32_t order = 2;  ///< of the differences in space: 2 or 4
};

class Field {
public:
    Field(const FieldDef& def, std::pmr::memory_resource* memory);

    const FieldDef& def() const { return def_; }
    std::size_t cells() const { return height_.size(); }
    /// Largest stable dt of one step: Courant number 1 / sqrt(2) in two dimensions, less a tenth.
    static float stable_step(const FieldDef& def, float gravity);

    /// One leapfrog step: velocities by the slope (Eq. 7), then heights by the divergence (Eq. 8). No numerical
    /// damping.
    void step(float dt, float gravity, std::uint32_t threads);
    /// The second term of Eq. 10: velocities += factor * gradient of pressure; factor = dt / density. The pressure is an
    /// array of `columns` by `rows` cells, not zero within `where`, whose cell (0, 0) lies on cell (di, dj) of this field.
    void push(const float* pressure, std::int32_t columns, std::int32_t rows, const Rect& where, std::int32_t di,
              std::int32_t dj, float factor);

    /// Bilinear; zero outside.
    float height_at(const GridOrigin& origin, float x, float y) const;
    void velocity_at(const GridOrigin& origin, float x, float y, float& u, float& v) const;

    float* height() { return height_.data(); }
    const float* height() const { return height_.data(); }
    /// Face i lies between cells i - 1 and i: [ny][nx + 1].
    float* velocity_x() { return u_.data(); }
    const float* velocity_x() const { return u_.data(); }
    /// Face j lies between cells j - 1 and j: [ny + 1][nx].
    float* velocity_y() { return v_.data(); }
    const float* velocity_y() const { return v_.data(); }

    void calm();
    /// Moves the window over the water: what was at cell (i + di, j + dj) is at (i, j) afterwards; new cells are calm.
    void shift(std::int32_t di, std::int32_t dj);
    void hash(StateHash& hash) const;

private:
    void step_velocities(float factor, float outflow, std::uint32_t threads);
    void step_heights(float factor, std::uint32_t threads);
    void damp(float dt, float speed);

    FieldDef def_;
    std::pmr::vector<float> height_, u_, v_;
};

/// Moves the contents of an nx by ny array by whole cells, zero where nothing was.
void shift_array(float* data, std::int32_t nx, std::int32_t ny, std::int32_t di, std::int32_t dj);

}  // namespace frm
