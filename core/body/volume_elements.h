// The volume of a body in elements of half a cell of the water, and in coarser ones: what it lays on the water. Made
// when a body meets its water, from rays through the body's lattice.
#pragma once

#include <array>
#include <memory_resource>
#include <vector>

#include "core/kernels/wet_kernels.h"
#include "core/map/map.h"
#include "core/water/pyramid.h"

namespace frm {

class VolumeElements {
public:
    /// `cell` is the water's, in the map's lengths; `levels` are the footprint's.
    VolumeElements(const Map& map, float cell, int levels, std::pmr::memory_resource* memory);

    /// Sixteen elements that lie together, and the box around their centroids and thickness.
    struct Block {
        OnLines<ElementBlock> element;
        float centre[3], half[3];
    };
    using Blocks = std::pmr::vector<Block>;

    /// Elements of 2^level cells at most along each axis, at finest() of half that; empty below it.
    const Blocks& at(int level) const { return level_[static_cast<std::size_t>(level)]; }
    int finest() const { return finest_; }

private:
    std::array<Blocks, Pyramid::most_levels> level_;
    int finest_ = 0;
};

}  // namespace frm
