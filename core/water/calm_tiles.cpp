#include "core/water/calm_tiles.h"

#include <algorithm>

namespace frm {

CalmTiles::CalmTiles(std::int32_t nx, std::int32_t ny, bool skip, std::pmr::memory_resource* memory)
    : nx_(nx),
      ny_(ny),
      columns_((nx + side - 1) / side),
      rows_((ny + side - 1) / side),
      skip_(skip),
      stepped_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), skip ? 0u : 1u, memory),
      next_(stepped_.size(), 0u, memory),
      in_row_(static_cast<std::size_t>(rows_), 0, memory),
      block_of_row_(static_cast<std::size_t>(rows_), -1, memory),
      spans_(memory),
      blocks_(memory) {
    spans_.reserve(static_cast<std::size_t>((columns_ + 1) / 2) * static_cast<std::size_t>(rows_));
    blocks_.reserve(static_cast<std::size_t>(rows_));
    rebuild();
}

void CalmTiles::wake(const Rect& cells) {
    if (!skip_ || cells.empty()) return;
    const Rect r = Rect{cells.i0 - reach, cells.j0 - reach, cells.i1 + reach, cells.j1 + reach}.clipped(nx_, ny_);
    if (r.empty()) return;
    const std::int32_t x0 = r.i0 / side, x1 = (r.i1 - 1) / side, y0 = r.j0 / side, y1 = (r.j1 - 1) / side;
    bool changed = false;
    for (std::int32_t y = y0; y <= y1; ++y)
        for (std::int32_t x = x0; x <= x1; ++x) {
            changed = changed || !stepped_[at(x, y)];
            stepped_[at(x, y)] = 1;
        }
    if (changed) rebuild();
}

bool CalmTiles::rest(const Rect& cells) const {
    const Rect r = cells.clipped(nx_, ny_);
    if (active_cells_ == 0 || r.empty()) return true;
    for (std::int32_t y = r.j0 / side; y <= (r.j1 - 1) / side; ++y)
        for (std::int32_t x = r.i0 / side; x <= (r.i1 - 1) / side; ++x)
            if (stepped_[at(x, y)]) return false;
    return true;
}

void CalmTiles::sleep_all() {
    if (!skip_) return;
    clock_ = 0;
    std::fill(stepped_.begin(), stepped_.end(), 0u);
    rebuild();
}

// Tile rows in whose columns the same is stepped become one block.
void CalmTiles::rebuild() {
    spans_.clear();
    blocks_.clear();
    active_cells_ = 0;
    for (std::int32_t ty = 0; ty < rows_; ++ty) {
        const std::int32_t r0 = ty * side, r1 = std::min(ny_, r0 + side);
        const std::size_t first = spans_.size();
        std::int32_t count = 0;
        for (std::int32_t tx = 0; tx < columns_; ++tx) {
            if (!stepped_[at(tx, ty)]) continue;
            ++count;
            const std::int32_t i0 = tx * side, i1 = std::min(nx_, i0 + side);
            if (spans_.size() > first && spans_.back().i1 == i0)
                spans_.back().i1 = i1;
            else
                spans_.push_back({i0, i1});
            active_cells_ += static_cast<std::size_t>((i1 - i0) * (r1 - r0));
        }
        in_row_[static_cast<std::size_t>(ty)] = count;
        block_of_row_[static_cast<std::size_t>(ty)] = -1;
        if (count == 0) continue;
        const Span *begin = spans_.data() + first, *end = spans_.data() + spans_.size();
        const auto same = [](const Span& a, const Span& b) { return a.i0 == b.i0 && a.i1 == b.i1; };
        if (!blocks_.empty() && blocks_.back().r1 == r0 &&
            std::equal(begin, end, blocks_.back().begin, blocks_.back().end, same)) {
            blocks_.back().r1 = r1;
            spans_.resize(first);
        } else {
            blocks_.push_back({r0, r1, begin, end});
        }
        block_of_row_[static_cast<std::size_t>(ty)] = static_cast<std::int32_t>(blocks_.size()) - 1;
    }
}

void CalmTiles::hash(StateHash& hash) const {
    if (!skip_) return;
    hash.value(clock_);
    hash.words(stepped_.data(), stepped_.size());
}

}  // namespace frm
