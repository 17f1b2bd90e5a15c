// Where the body cuts the lattice: which cells are inside it, and every link between a fluid cell and the wall.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/flow/domain.h"
#include "bake/flow/flow.h"
#include "bake/flow/lattice.h"

namespace frm::bake::flow {

/// The half of a cut lattice link that lies in the water of one cell. The population that comes back along it is
/// weight[0] f_i(cell) + weight[1] f_opposite(cell) + weight[2] f_i(far) + wall, all after collision.
struct Link {
    std::uint64_t cell = 0;  ///< the fluid cell
    std::uint64_t far = 0;   ///< the cell behind it, away from the wall (the cell itself when unused)
    std::uint64_t into = 0;  ///< the cell behind the wall, in whose memory the population waits to be pulled
    float weight[3] = {1, 0, 0};
    float wall = 0;              ///< what the wall's own motion adds
    std::uint8_t direction = 0;  ///< i, from the cell to the wall
    std::uint32_t region = 0;
    float normal[3] = {};  ///< of the triangle hit, into the water, stream's frame
    float arm[3] = {};     ///< from the mesh's origin to the wall point, in finest cells, stream's frame
};

/// A stretch of cells in a row that the body fills.
struct SolidRun {
    std::uint32_t row = 0;              ///< counted without ghosts
    std::uint32_t first = 0, last = 0;  ///< [first, last)
};

struct Body {
    std::vector<Link> links;      ///< by region, then cell, then direction
    std::vector<SolidRun> solid;  ///< by row
};

Body cut_links(const Domain& domain, const Regions& regions);

}  // namespace frm::bake::flow
