// How thick a shape is: what is thinner than a cell of the flow's grid is solved poorly.
#pragma once

#include "bake/mesh/surface.h"

namespace frm::bake {

struct Thickness {
    double thinnest = 0;  ///< m; 1 % of the surface bounds parts that are thinner
    double median = 0;    ///< m; half of the surface does
    Vec3d thinnest_at;    ///< a point on the surface where it is `thinnest`, m
};

/// The depth of the shape under 4,096 points spread evenly over the surface of repair(), straight inward, through pieces
/// that overlap. An estimate: a needle or a fin of less than a percent of the surface is not in it. Of a tangle of
/// triangles fewer points are taken. Zeros if no point has a depth.
Thickness measure_thickness(const Surface& surface);

}  // namespace frm::bake
