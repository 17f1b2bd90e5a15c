// The rotations and reflections that carry a body into itself: only one of the directions that they carry into each
// other has to be solved.
#pragma once

#include <string>
#include <vector>

#include "bake/math/matrix.h"
#include "bake/mesh/surface.h"

namespace frm::bake {

enum class SymmetryKind {
    finite,          ///< the elements of a group, at most 120
    axial,           ///< any rotation about an axis, and mirrors in all planes through it: a cone
    axial_mirrored,  ///< also the mirror in the plane across the axis: a cylinder
    spherical,       ///< any rotation and reflection
};

const char* name_of(SymmetryKind kind);

struct SymmetryOptions {
    /// How far the surface may be from its image, in both directions, as a share of the body's width: the radius about
    /// its thinnest axis of inertia, at most that of the bounding sphere. (A share of a long body's length would let
    /// the camber of its section, or the corners of a square rod, pass for nothing.)
    double tolerance = 0.005;
    /// Flat facets of a round body may be this far from the round shape that their vertices are on; the vertices
    /// themselves must be within `tolerance` of it. The chords of 16 sides are off by 1.9 %, those of 24 by 0.9 %.
    double chord_tolerance = 0.02;
};

struct Symmetry {
    SymmetryKind kind = SymmetryKind::finite;
    /// Orthogonal matrices about `centre`, closed under multiplication, in the order of span_group(): the identity
    /// first. Only the identity where a continuous family is.
    std::vector<Matrix3> elements{Matrix3{}};
    Vec3d centre;           ///< centroid of the volume, m
    Vec3d axis{0, 0, 1};    ///< of axial and axial_mirrored, unit; its largest component is positive
    double size = 0;        ///< m, what the tolerances are shares of
    double tolerance = 0;   ///< m, what was allowed: that of chords for continuous families
    double worst = 0;       ///< m, the largest distance that was measured, at most `tolerance`
    Vec3d inside{0, 0, 1};  ///< a direction well inside the fundamental domain of `elements`
};

/// Finds the symmetry of a closed surface (see repair()): rotations by 1/2 to 1/12 of a turn, reflections, and what
/// they make together, about the centroid.
Symmetry find_symmetry(const Surface& surface, const SymmetryOptions& options = {});

struct Canonical {
    Vec3d direction;  ///< unit, in the fundamental domain, the same for all that are carried into each other
    Matrix3 element;  ///< carries `direction` to the one asked for
};

/// Carries a direction (not zero) into the fundamental domain. The force on the body in a stream along d is
/// element * (force in a stream along canonical.direction); torques about the centre also change sign with a
/// reflection: determinant(element) * element * torque.
///
/// The domain: for a finite group the directions that are nearer to `inside` than to its images; a half circle about
/// the axis, or a quarter for axial_mirrored; the point (0, 0, 1) for a sphere.
Canonical canonical(const Symmetry& symmetry, const Vec3d& direction);

/// "8 elements: 4 rotations, 4 reflections", "any rotation about (0, 0, 1), mirrored across", ...
std::string describe(const Symmetry& symmetry);

}  // namespace frm::bake
