// The D3Q19 lattice, how its cells lie in memory, and the two copies of the populations a run works on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <new>

namespace frm::bake::flow {

constexpr int direction_count = 19;

struct Direction {
    int x, y, z;
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

/// Cells in memory: rows along the stream, nx cells each, nx + 2 a multiple of 16. In a row, cell nx is the outlet's
/// ghost; the inlet's ghost of a row is the last cell of the row before it, so that rows start aligned and neighbours
/// along the stream are always one float away. Rows and layers of ghosts surround the box in y and z; a section has one
/// layer without ghosts and a layer stride of zero, which makes it periodic across.
struct Grid {
    static constexpr std::size_t lanes = 16;

    int nx = 0, ny = 0, nz = 0;
    bool section = false;

    std::size_t pitch() const { return static_cast<std::size_t>(nx) + 2; }
    std::ptrdiff_t stride_y() const { return static_cast<std::ptrdiff_t>(pitch()); }
    std::ptrdiff_t stride_z() const { return section ? 0 : stride_y() * (ny + 2); }
    std::size_t rows() const { return static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz); }
    std::size_t allocated_rows() const {
        return static_cast<std::size_t>(ny + 2) * static_cast<std::size_t>(section ? 1 : nz + 2);
    }
    std::size_t allocated() const { return pitch() * allocated_rows(); }
    std::uint64_t cells() const { return static_cast<std::uint64_t>(nx) * rows(); }

    std::size_t index(int i, int j, int k) const {
        return static_cast<std::size_t>((section ? 0 : (k + 1) * stride_z()) + (j + 1) * stride_y() + i);
    }
    std::ptrdiff_t offset(int direction) const {
        const Direction& c = directions[static_cast<std::size_t>(direction)];
        return c.x + c.y * stride_y() + c.z * stride_z();
    }
    /// First cell of a row, rows counted without ghosts.
    std::size_t row(std::size_t r) const {
        const auto j = static_cast<int>(r % static_cast<std::size_t>(ny));
        const auto k = static_cast<int>(r / static_cast<std::size_t>(ny));
        return index(0, j, k);
    }
};

/// Populations after collision, as differences from the fluid at rest (f - w): fp32 keeps its digits for the flow, and
/// a momentum exchange computed from them is free of the reference pressure (Skordos 1993).
class Populations {
public:
    explicit Populations(const Grid& grid)
        : stride_(stride(grid)), memory_(static_cast<float*>(::operator new(bytes(grid), alignment))) {
        const std::size_t count = bytes(grid) / sizeof(float);
        for (std::size_t i = 0; i < count; ++i) memory_.get()[i] = 0;
    }

    float* at(int direction) { return memory_.get() + offset(direction); }
    const float* at(int direction) const { return memory_.get() + offset(direction); }

    static std::size_t bytes(const Grid& grid) {
        return (direction_count * stride(grid) + Grid::lanes) * sizeof(float);
    }

private:
    static constexpr std::align_val_t alignment{64};
    struct Free {
        void operator()(float* p) const { ::operator delete(p, alignment); }
    };

    /// A row of slack before each direction, for the inlet ghost of the very first row; an odd number of cache lines
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
