// One time step of the bulk: pull the populations from the neighbours, collide, store. Knows nothing of walls.
#pragma once

#include <cstddef>

#include "bake/flow/lattice.h"

namespace frm::bake::flow {

struct Collision {
    const float* relaxation = nullptr;  ///< relaxation time of the molecular viscosity for each cell of a row
    float smagorinsky = 0;              ///< the model's constant, squared
    float push[3] = {};                 ///< velocity gained by the fluid in this step (the start-up's acceleration)
};

/// Row r of `to` from the neighbours in `from`. The row's ghosts are left with no meaning.
void collide_row(const Grid& grid, const Populations& from, Populations& to, std::size_t r, const Collision& collision);

}  // namespace frm::bake::flow
