// The closed triangle surface that everything in the bake works on, in metres, in the mesh file's own frame.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math/vec.h"

namespace frm::bake {

using Triangle = std::array<std::uint32_t, 3>;

/// Closed and consistently oriented: counter-clockwise seen from outside, so that normals point into the water.
struct Surface {
    std::vector<Vec3d> vertices;
    std::vector<Triangle> triangles;

    Vec3d corner(std::size_t triangle, int i) const {
        return vertices[triangles[triangle][static_cast<std::size_t>(i)]];
    }
};

/// A surface split into haptic regions (section 4 of the paper): region[t] is the region of triangle t, 0 <= region[t]
/// < count.
struct Regions {
    std::vector<std::uint32_t> region;
    std::uint32_t count = 0;
};

struct SurfaceProperties {
    double area = 0;    ///< m^2
    double volume = 0;  ///< m^3, positive
    Vec3d centroid;     ///< of the enclosed volume, m
    Vec3d low, high;    ///< bounding box, m
};

SurfaceProperties measure(const Surface& surface);
double longest_side(const SurfaceProperties& shape);  ///< of the bounding box, m

/// Area of the surface's shadow along a unit direction, m^2 (of the outline: overlapping parts are counted once).
double projected_area(const Surface& surface, const Vec3d& direction);

}  // namespace frm::bake
