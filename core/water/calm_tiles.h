// Which parts of a wave field are stepped: tiles of 32 x 32 cells that are calm, and whose neighbours are, rest at zero.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "core/math/hash.h"
#include "core/water/rect.h"

namespace frm {

/// Columns i0 <= i < i1 of a row.
struct Span {
    std::int32_t i0, i1;
};

/// Rows that are stepped in the same columns.
struct Block {
    std::int32_t r0 = 0, r1 = 0;  ///< cells
    const Span *begin = nullptr, *end = nullptr;
};

/// A tile is loud when something in it is above the field's threshold. Stepped are the loud ones, and those that have
/// something loud within `reach` cells of them; it is looked at every `interval` steps, in which a wave runs less than
/// that.
class CalmTiles {
public:
    static constexpr std::int32_t side = 32;
    static constexpr std::uint32_t interval = 8;
    static constexpr std::int32_t reach = 8;

    /// Without `skip` all tiles are stepped, always.
    CalmTiles(std::int32_t nx, std::int32_t ny, bool skip, std::pmr::memory_resource* memory);

    bool skips() const { return skip_; }
    std::size_t active_cells() const { return active_cells_; }
    /// From below upwards.
    const std::pmr::vector<Block>& blocks() const { return blocks_; }
    /// Null where all is calm.
    const Block* block_of(std::int32_t row) const {
        const std::int32_t b = block_of_row_[static_cast<std::size_t>(row / side)];
        return b < 0 ? nullptr : &blocks_[static_cast<std::size_t>(b)];
    }

    /// Something is written into these cells, or their faces.
    void wake(const Rect& cells);
    /// None of these cells is stepped: all is zero there.
    bool rest(const Rect& cells) const;
    void sleep_all();

    /// Steps until the next look.
    std::uint32_t steps_left() const { return skip_ ? interval - clock_ : ~0u; }
    void count(std::uint32_t steps) { clock_ += steps; }
    bool due() const { return skip_ && clock_ >= interval; }
    /// `loud(cells, share)` says whether something is above that share of the threshold; `zero(cells)` puts a tile to
    /// rest. A neighbour is stepped from a quarter of the threshold on: what is cut off at a tile's edge leaves a
    /// current there that runs nowhere, and must not itself be loud.
    template <typename Loud, typename Zero>
    void look(const Loud& loud, const Zero& zero);

    void hash(StateHash& hash) const;

private:
    Rect cells_of(std::int32_t tx, std::int32_t ty) const {
        return Rect{tx * side, ty * side, (tx + 1) * side, (ty + 1) * side}.clipped(nx_, ny_);
    }
    std::size_t at(std::int32_t tx, std::int32_t ty) const {
        return static_cast<std::size_t>(ty) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(tx);
    }
    void rebuild();

    std::int32_t nx_, ny_, columns_, rows_;
    bool skip_;
    std::uint32_t clock_ = 0;
    std::size_t active_cells_ = 0;
    std::pmr::vector<std::uint32_t> stepped_, next_;  ///< words, so that they can be hashed
    std::pmr::vector<std::int32_t> in_row_;           ///< how many of a row's tiles are stepped
    std::pmr::vector<std::int32_t> block_of_row_;
    std::pmr::vector<Span> spans_;
    std::pmr::vector<Block> blocks_;
};

template <typename Loud, typename Zero>
void CalmTiles::look(const Loud& loud, const Zero& zero) {
    clock_ = 0;
    constexpr std::uint32_t is_near = 1, is_loud = 2;
    const auto each_stepped = [&](const auto& use) {
        for (std::int32_t ty = 0; ty < rows_; ++ty)
            for (std::int32_t tx = 0; in_row_[static_cast<std::size_t>(ty)] > 0 && tx < columns_; ++tx)
                if (stepped_[at(tx, ty)]) use(tx, ty);
    };
    each_stepped([&](std::int32_t tx, std::int32_t ty) {
        if (loud(cells_of(tx, ty), 1.0f)) next_[at(tx, ty)] = is_loud;
    });
    each_stepped([&](std::int32_t tx, std::int32_t ty) {
        if (next_[at(tx, ty)] != is_loud) return;
        for (std::int32_t dy = -1; dy <= 1; ++dy)
            for (std::int32_t dx = -1; dx <= 1; ++dx) {
                const std::int32_t x = tx + dx, y = ty + dy;
                if (x < 0 || y < 0 || x >= columns_ || y >= rows_ || next_[at(x, y)]) continue;
                Rect edge = cells_of(tx, ty);
                if (dx > 0) edge.i0 = std::max(edge.i0, edge.i1 - reach);
                if (dx < 0) edge.i1 = std::min(edge.i1, edge.i0 + reach);
                if (dy > 0) edge.j0 = std::max(edge.j0, edge.j1 - reach);
                if (dy < 0) edge.j1 = std::min(edge.j1, edge.j0 + reach);
                if (loud(edge, 0.25f)) next_[at(x, y)] = is_near;
            }
    });
    bool changed = false;
    for (std::int32_t ty = 0; ty < rows_; ++ty) {
        const std::int32_t around = in_row_[static_cast<std::size_t>(ty)] +
                                    (ty > 0 ? in_row_[static_cast<std::size_t>(ty - 1)] : 0) +
                                    (ty + 1 < rows_ ? in_row_[static_cast<std::size_t>(ty + 1)] : 0);
        if (around == 0) continue;
        for (std::int32_t tx = 0; tx < columns_; ++tx) {
            std::uint32_t &now = stepped_[at(tx, ty)], &next = next_[at(tx, ty)];
            if (now && !next) zero(cells_of(tx, ty));
            changed = changed || (now != 0) != (next != 0);
            now = next != 0;
            next = 0;
        }
    }
    if (changed) rebuild();
}

}  // namespace frm
