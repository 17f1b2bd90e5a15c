// The D3Q19 lattice, how the cells of one block lie in memory, and a copy of the populations in them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace frm::bake::flow {

constexpr int direction_count = 19;

struct Direction {
    int x, y, z;
    int along(int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

/// Rest first, then pairs of opposites whose first member has a positive first component.
// clang-format off
constexpr std::array<Direction, direction_count> directions{{
    {0, 0, 0},
    {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1},
    {1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {-1, 1, 0},
    {1, 0, 1}, {-1, 0, -1}, {1, 0, -1}, {-1, 0, 1},
    {0, 1, 1}, {0, -1, -1}, {0, 1, -1}, {0, -1, 1},
}};
// clang-format on

constexpr float weight(int i) { return i == 0 ? 1.0f / 3 : i < 7 ? 1.0f / 18 : 1.0f / 36; }
constexpr int opposite(int i) { return i == 0 ? 0 : ((i - 1) ^ 1) + 1; }

/// One block's cells in memory: rows along the stream, ghosts all round. In a row, cell nx is the ghost behind; the
/// ghost ahead is the last cell of the row before it, so that rows start aligned and neighbours along the stream are
/// always one float away. A periodic block has no ghosts in z: its layers wrap around.
struct Grid {
    static constexpr std::size_t lanes = 16;

    int nx = 0, ny = 0, nz = 0;
    bool periodic = false;

    std::size_t pitch() const { return (static_cast<std::size_t>(nx) + 2 + lanes - 1) / lanes * lanes; }
    std::ptrdiff_t stride_y() const { return static_cast<std::ptrdiff_t>(pitch()); }
    std::ptrdiff_t stride_z() const { return stride_y() * (ny + 2); }
    std::size_t rows() const { return static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz); }
    std::size_t layers() const { return static_cast<std::size_t>(periodic ? nz : nz + 2); }
    std::size_t allocated_rows() const { return static_cast<std::size_t>(ny + 2) * layers(); }
    std::size_t allocated() const { return pitch() * allocated_rows(); }
    std::uint64_t cells() const { return static_cast<std::uint64_t>(nx) * rows(); }
    int size(int axis) const { return axis == 0 ? nx : axis == 1 ? ny : nz; }

    std::size_t index(int i, int j, int k) const {
        return static_cast<std::size_t>((periodic ? k : k + 1) * stride_z() + (j + 1) * stride_y() + i);
    }
    int wrap(int k) const { return !periodic ? k : k < 0 ? k + nz : k >= nz ? k - nz : k; }
    int layer_of(std::size_t cell) const {
        const auto k = static_cast<int>(cell / static_cast<std::size_t>(stride_z()));
        return periodic ? k : k - 1;
    }
    /// From a cell of layer k to its neighbour.
    std::ptrdiff_t offset(int direction, int k) const {
        const Direction& c = directions[static_cast<std::size_t>(direction)];
        return c.x + c.y * stride_y() + (wrap(k + c.z) - k) * stride_z();
    }
    std::size_t neighbour(std::size_t cell, int direction) const {
        return cell + static_cast<std::size_t>(offset(direction, layer_of(cell)));
    }
    /// First cell of a row, rows counted without ghosts.
    std::size_t row(std::size_t r) const { return index(0, row_y(r), row_z(r)); }
    int row_y(std::size_t r) const { return static_cast<int>(r % static_cast<std::size_t>(ny)); }
    int row_z(std::size_t r) const { return static_cast<int>(r / static_cast<std::size_t>(ny)); }
};

/// 38 rows far apart are in use at a time, more than pages of 4 kB have entries for in the processor's tables.
inline void ask_for_large_pages(void* memory, std::size_t bytes) {
#if defined(__linux__)
    madvise(memory, bytes, MADV_HUGEPAGE);
#else
    static_cast<void>(memory);
    static_cast<void>(bytes);
#endif
}

/// Populations after collision, as differences from the fluid at rest (f - w): fp32 keeps its digits for the flow, and
/// a momentum exchange computed from them is free of the reference pressure (Skordos 1993).
class Populations {
public:
    explicit Populations(const Grid& grid)
        : stride_(stride(grid)), memory_(static_cast<float*>(::operator new(bytes(grid), alignment))) {
        ask_for_large_pages(memory_.get(), bytes(grid));
        const std::size_t count = bytes(grid) / sizeof(float);
        for (std::size_t i = 0; i < count; ++i) memory_.get()[i] = 0;
    }

    float* at(int direction) { return memory_.get() + offset(direction); }
    const float* at(int direction) const { return memory_.get() + offset(direction); }

    /// Floats from one direction's populations to the next.
    static std::ptrdiff_t apart(const Grid& grid) { return static_cast<std::ptrdiff_t>(stride(grid)); }

    static std::size_t bytes(const Grid& grid) {
        return (direction_count * stride(grid) + 2 * Grid::lanes) * sizeof(float);
    }

private:
    static constexpr std::align_val_t alignment{std::size_t{1} << 21};
    struct Free {
        void operator()(float* p) const { ::operator delete(p, alignment); }
    };

    /// A row of slack before each direction, for the ghost ahead of the very first row; an odd number of cache lines
    /// apart, so that the 19 streams of a row do not fall on the same cache sets.
    static std::size_t stride(const Grid& grid) {
        const std::size_t lines = grid.allocated() / Grid::lanes + 2;
        return (lines + (lines % 2 == 0 ? 1 : 0)) * Grid::lanes;
    }
    std::size_t offset(int direction) const { return static_cast<std::size_t>(direction) * stride_ + Grid::lanes; }

    std::size_t stride_;
    std::unique_ptr<float, Free> memory_;
};

}  // namespace frm::bake::flow
