// From surfaces, regions and series to a Map: the sources, the means, and the fluctuations as whole multiples of a
// step.
#pragma once

#include <vector>

#include "bake/mesh/surface.h"
#include "core/map/map.h"

namespace frm::bake {

/// Geometry and sources. The triangles are put in the order of their regions.
void fill_surface(Map& map, const Surface& surface, const Regions& regions);

/// The fluctuations of one direction, before they are rounded: [source][sample][component], N.
using Fluctuation = std::vector<float>;

/// Rounds the fluctuations so that the whole force errs by about `budget` of its peak at most, and writes the largest
/// error found to facts.quantisation_error. map.mean, sources, directions and samples must be there; one entry of
/// `directions` each.
void fill_fluctuations(Map& map, const std::vector<Fluctuation>& directions, double budget);

}  // namespace frm::bake
