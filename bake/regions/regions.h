// Haptic regions (section 4 of the paper): the patches whose resistance the map stores, one source in each.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/error.h"
#include "bake/mesh/surface.h"

namespace frm::bake {

constexpr std::uint32_t kMostRegions = 4096;

struct RegionProperties {
    /// Area-weighted centroid, m: the haptic source. It is not moved onto the surface, though it lies under a curved
    /// region: a rigid body's velocity is linear in position, so its value here is exactly the region's mean.
    Vec3d centre;
    Vec3d normal;     ///< of the area-weighted mean normal; unit, or zero for a region that closes on itself
    double area = 0;  ///< m^2
};

/// Splits a closed surface (see repair()) into exactly `count` regions, 1 to 4096: connected, compact, of similar
/// normal and similar area. Front and back of a thin blade are never one region unless there are fewer regions than
/// that takes. Each shell has its share of the regions by area, at least one; only with fewer regions than shells does
/// a region span several.
///
/// Regions are made of whole triangles: for areas to be similar, tessellate() to some 20 triangles a region or more.
/// The same input always gives the same regions. Throws BakeError for a count that is out of range or above the
/// number of triangles.
Regions split_regions(const Surface& surface, std::uint32_t count);

/// One entry a region.
std::vector<RegionProperties> region_properties(const Surface& surface, const Regions& regions);

}  // namespace frm::bake
