// The images of a flow under the body's symmetry: where one solved direction is also known, and by which isometries.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/symmetry/symmetry.h"

namespace frm::bake {

/// A direction in which a solved flow is known: g times the solved one for every g of `by`. Where there are several, the
/// mean flow is the mean of those images (and its own noise the less).
struct Image {
    Vec3d direction;
    std::vector<Matrix3> by;
};

/// All images of a unit direction, the direction itself first. A continuous symmetry is sampled so that no direction is
/// farther than about `spacing` radians from one of the images it could have.
std::vector<Image> images(const Symmetry& symmetry, const Vec3d& direction, double spacing);

/// The least of the angles between two directions' images, radians.
double apart(const Symmetry& symmetry, const Vec3d& a, const Vec3d& b);

}  // namespace frm::bake
