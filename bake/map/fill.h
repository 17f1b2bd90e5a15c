// From surfaces, regions and what the flows gave to a Map: the sources, and the forces as whole multiples of steps.
#pragma once

#include <vector>

#include "bake/mesh/surface.h"
#include "core/map/map.h"

namespace frm::bake {

/// Geometry and sources. The triangles are put in the order of their regions.
void fill_surface(Map& map, const Surface& surface, const Regions& regions);

/// The fluctuations of one direction about their mean: [source][sample][component], N.
using Fluctuation = std::vector<float>;

/// The forces before they are rounded, as flows or a fit gave them, N, at the map's own size and fluid.
struct Tables {
    std::vector<SourceForce> mean;         ///< [speed][direction][source], each at its own speed (not the base speed)
    std::vector<Fluctuation> fluctuation;  ///< [fluctuation direction], at the base speed
};

/// Rounds the tables into the map: means to `budget` / 3 and fluctuations to two thirds of it, as shares of the peak
/// force on the whole object. Friction's means have a step of their own, to about five times that share of friction's
/// own peak where that is finer: at low speed they matter by themselves. The largest error found goes to
/// facts.quantisation_error: at most `budget` (above 0, below 1), unless a table's largest value is more than 32767 of
/// the steps that this takes; then it is what it is. The map must have its sources, directions,
/// fluctuation_directions, speeds, samples and facts.base_speed; the sizes of the tables must match, and all must be
/// finite (throws Error, FRM_ERROR_INTERNAL, naming what is not).
void fill_tables(Map& map, const Tables& tables, double budget);

/// The largest error of the force on the whole object that comes of the map's rounding, as a share of its peak in the
/// tables: the worst mean, of all speeds and directions, plus the worst sample of a fluctuation. What fill_tables()
/// writes, and what `frm verify --against` works out anew. Throws Error if the sizes do not match.
double rounding_error(const Map& map, const Tables& tables);

}  // namespace frm::bake
