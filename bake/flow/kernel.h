// The loops over cells: one time step of the bulk (pull the populations from the neighbours, collide, store), and the
// two halves of it that blocks of different cell size exchange. Knows nothing of walls.
#pragma once

#include <array>
#include <cstddef>

#include "bake/flow/lattice.h"
#include "bake/flow/turning.h"

namespace frm::bake::flow {

struct Collision {
    const float* relaxation = nullptr;  ///< relaxation time of the molecular viscosity for each cell of a row
    float smagorinsky = 0;              ///< the model's constant, squared
    float push[3] = {};                 ///< velocity gained by the fluid in this step (the start-up's acceleration)
};

/// What blocks exchange of a cell: density less one, velocity, and stress over relaxation time (xx, yy, zz, xy, xz,
/// yz), which is the rate of strain but for constants: smooth across a change of cell size, where populations are not.
constexpr int field_count = 10;
using Fields = std::array<float*, field_count>;
using ConstFields = std::array<const float*, field_count>;

/// Cells of a row whose fields, as they are before the collision, are kept on the way.
struct Wanted {
    struct Cells {
        std::size_t begin, end;
        Fields to;  ///< of cell `begin`
    };
    static constexpr std::size_t most = 12;  ///< one for each face of two borders

    std::array<Cells, most> cells;
    std::size_t count = 0;

    void add(int first, int size, const Fields& to) {
        cells[count++] = {static_cast<std::size_t>(first), static_cast<std::size_t>(first + size), to};
    }
};

/// Row r of `to` from the neighbours in `from`. The row's ghosts are left with no meaning.
void collide_row(const Grid& grid, const Populations& from, Populations& to, std::size_t r, const Collision& collision,
                 const Wanted& wanted);

/// The same in the turning frame; there is no push then.
void collide_row(const Grid& grid, const Populations& from, Populations& to, std::size_t r, const Collision& collision,
                 const Wanted& wanted, const Turning& turning);

/// Fields of `count` cells from (i, j, k) on along x, of the step that pulls from `from`. `relaxation` is one time.
void observe(const Grid& grid, const Populations& from, int i, int j, int k, std::size_t count, float relaxation,
             float smagorinsky, const Fields& fields);

/// Populations after collision of cells with these fields, their strain times `scale` (the ratio of the time steps).
/// out[i] takes those of direction i.
void rebuild(const ConstFields& fields, std::size_t count, float scale, float relaxation, float smagorinsky,
             const float* push, const std::array<float*, direction_count>& out);

}  // namespace frm::bake::flow
