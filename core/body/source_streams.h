// What the last tick found at each haptic source, kept in the body's frame as the kernels leave it; turned to the world
// only for those who look.
#pragma once

#include <memory_resource>
#include <vector>

#include "core/kernels/lookup.h"
#include "core/math/quat.h"

namespace frm {

struct SourceStreams {
    SourceStreams(std::size_t sources, std::pmr::memory_resource* memory)
        : block((sources + lookup_block - 1) / lookup_block, LookupBlock{}, memory) {}

    std::pmr::vector<LookupBlock> block;
    Rotation<float> rotation;  ///< of the body in that tick
    bool grouped = false;      ///< the tick looked up groups; the blocks are older
    LookupMotion motion{};     ///< of that tick

    Vec3f pressure(std::size_t l) const {
        const float* v = block[l / lookup_block].force[l % lookup_block].v;
        return {v[0], v[1], v[2]};
    }
    void forget() {
        grouped = false;
        block.assign(block.size(), LookupBlock{});
    }
};

}  // namespace frm
