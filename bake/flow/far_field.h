// What surrounds the box: the uniform stream ahead and beside it, an open end behind it; or, in the frame that turns
// with the body, water that stands still and so goes round.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "bake/flow/lattice.h"
#include "bake/flow/turning.h"

namespace frm::bake::flow {

/// Populations of a uniform stream of the fluid's density at rest, less those of the fluid at rest.
std::array<float, direction_count> stream_populations(const std::array<float, 3>& velocity);

/// Fills the ghosts that hold the stream: rows and layers beside the box and the inlet of every row.
///
/// Populations that enter are those of the undisturbed stream, those that leave are lost. To first order that is the
/// characteristic condition, so sound leaves through inlet and sides; for the flow proper the sides are walls that move
/// with the stream and give way a little.
void fill_stream(const Grid& grid, Populations& populations, const std::array<float, direction_count>& stream);

/// Puts back the two ghosts of a row after the collision has run over them: the inlet's holds the stream; the outlet's
/// is the equilibrium of the last cell, its density drawn a little to the stream's so that the level of pressure cannot
/// drift, its flow never inwards. Not `open`: it holds the stream too (still water).
void close_row(const Grid& grid, Populations& populations, std::size_t row,
               const std::array<float, direction_count>& stream, bool open);

/// Relaxation time for each cell of a row: the fluid's, and in the last `sponge` cells before the outlet rising to 1,
/// where the wake dissolves before it meets the outlet.
std::vector<float> relaxation_times(const Grid& grid, double base, double sponge);

/// In the turning frame: what a cell at (x, y) of water at rest holds after the collision.
std::array<float, direction_count> still_populations(const Turning& turning, float x, float y);

/// Fills all ghosts with water at rest, and, after the collision has run over a row, what of it is in the water that is
/// held at rest: its two ghosts and all cells farther than `reach` cells from the axis, where the water is the faster
/// the farther. To first order that is the characteristic condition again; where the flow leaves the box, the cells
/// before are thick enough to follow.
void fill_still(const Grid& grid, Populations& populations, const Turning& turning);
void close_row_still(const Grid& grid, Populations& populations, std::size_t row, const Turning& turning, double reach);

/// Relaxation times [row][pitch] of a box with `sponge` cells of raised viscosity before the water that is held at
/// rest. Water at rest turns as a whole and does not feel it.
std::vector<float> still_relaxation_times(const Grid& grid, double base, double sponge, const Turning& turning,
                                          double reach);

}  // namespace frm::bake::flow
