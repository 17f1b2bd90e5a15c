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

    Vec3f stream(std::size_t l) const {
        const LookupBlock& b = block[l / lookup_block];
        return {b.x[l % lookup_block], b.y[l % lookup_block], b.z[l % lookup_block]};
    }
    const ForceRow& force(std::size_t l) const { return block[l / lookup_block].force[l % lookup_block]; }
    Vec3f pressure(std::size_t l) const {
        const float* v = force(l).v;
        return {v[0], v[1], v[2]};
    }
    Vec3f friction(std::size_t l) const {
        const float* v = force(l).v;
        return {v[4], v[5], v[6]};
    }
    void forget() { block.assign(block.size(), LookupBlock{}); }
};

}  // namespace frm
