// A rectangle of cells.
#pragma once

#include <cstdint>

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
    /// What of it lies within nx by ny cells; Rect() if nothing does.
    Rect clipped(std::int32_t nx, std::int32_t ny) const {
        const Rect r{i0 < 0 ? 0 : i0, j0 < 0 ? 0 : j0, i1 > nx ? nx : i1, j1 > ny ? ny : j1};
        return r.empty() ? Rect() : r;
    }
    Rect moved(std::int32_t di, std::int32_t dj) const { return {i0 + di, j0 + dj, i1 + di, j1 + dj}; }
};

}  // namespace frm
