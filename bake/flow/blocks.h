// How far each block of the nested grid reaches.
#pragma once

#include <vector>

#include "bake/flow/domain.h"
#include "core/math/vec.h"

namespace frm::bake::flow {

struct BlockRequest {
    Vec3d low, high;       ///< of the body, in finest cells from the lattice's origin
    double bulk = 0;       ///< size of the body, finest cells: margins are measured in it
    bool section = false;  ///< periodic across z
    int layers = 1;        ///< section: finest cells across z, 1 or a multiple of the coarsest cell
    bool still = false;    ///< no stream: as much room behind the body as ahead of it
    /// Where the blocks turn with the body about an axis along z: its largest distance from the axis, finest cells, and
    /// a point of the axis.
    double radius = 0;
    Vec3d axis;
};

/// Blocks from the finest to the coarsest. At most 1e6 cells along any axis; throws BakeError.
std::vector<Block> plan_blocks(const BlockRequest& request);

/// How many blocks a body of this size gets in a stream: also the power of two that `layers` is a multiple of.
int block_count(double bulk, bool section);

}  // namespace frm::bake::flow
