// Which parts of a wave field are stepped: tiles of 32 x 32 cells that are calm, and whose neighbours are, rest at zero.
#pragma once

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

/// A tile is loud when something in it is above the field's threshold. Stepped are the loud ones and the eight around
/// each; whether they still are loud is looked at every `interval` steps, in which a wave does not cross a tile.
class CalmTiles {
public:
    static constexpr std::int32_t side = 32;
    static constexpr std::uint32_t interval = 8;

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
    void sleep_all();

    /// Steps until the next look.
    std::uint32_t steps_left() const { return skip_ ? interval - clock_ : ~0u; }
    void count(std::uint32_t steps) { clock_ += steps; }
    bool due() const { return skip_ && clock_ >= interval; }
    /// `loud(cells)` says whether something in a tile is above the threshold; `zero(cells)` puts one to rest.
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
    void step_around(std::int32_t tx, std::int32_t ty, std::uint32_t* stepped);
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
    for (std::int32_t ty = 0; ty < rows_; ++ty) {
        if (in_row_[static_cast<std::size_t>(ty)] == 0) continue;
        for (std::int32_t tx = 0; tx < columns_; ++tx)
            if (stepped_[at(tx, ty)] && loud(cells_of(tx, ty))) step_around(tx, ty, next_.data());
    }
    bool changed = false;
    for (std::int32_t ty = 0; ty < rows_; ++ty) {
        const std::int32_t around = in_row_[static_cast<std::size_t>(ty)] +
                                    (ty > 0 ? in_row_[static_cast<std::size_t>(ty - 1)] : 0) +
                                    (ty + 1 < rows_ ? in_row_[static_cast<std::size_t>(ty + 1)] : 0);
        if (around == 0) continue;
        for (std::int32_t tx = 0; tx < columns_; ++tx) {
            std::uint32_t &now = stepped_[at(tx, ty)], &next = next_[at(tx, ty)];
            if (now && !next) zero(cells_of(tx, ty));
            changed = changed || now != next;
            now = next;
            next = 0;
        }
    }
    if (changed) rebuild();
}

}  // namespace frm
