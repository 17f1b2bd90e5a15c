// What the shape of the body alone says of the force in a stream: how much of the surface faces it, and how squarely.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "bake/directions/fit.h"
#include "bake/mesh/surface.h"

namespace frm::bake {

/// The pressure on a bluff body is, roughly, a function of the cosine c between the stream and the inward normal: it falls
/// from the stagnation pressure where the surface faces the stream (c = 1) to that of the wake, which is much the same
/// all over the lee. A cubic of c to windward that meets a uniform lee is a sum of three terms, each a force on every
/// region in any direction; the uniform part adds up to nothing over a closed surface. What is in the shadow of other
/// parts counts as if it were not. Their coefficients are the flows' business (DirectionFit).
class ShapePressure {
public:
    static constexpr std::size_t terms = 3;  ///< c, c^2, c^3 where c > 0
    using Term = std::array<Vec3d, terms>;

    ShapePressure(const Surface& surface, const Regions& regions, const Vec3d& centre);

    /// [region]: the force of each term at unit pressure, m^2.
    std::vector<Term> on_regions(const Vec3d& e) const;
    /// [term]: force (m^2) on the whole body and torque about the centre (m^3) divided by `size`.
    std::vector<FitValue> on_body(const Vec3d& e, double size) const;

private:
    struct Part {
        std::uint32_t region;
        Vec3d normal, arm;
        double area;
    };
    std::vector<Part> parts_;
    std::uint32_t regions_;
};

}  // namespace frm::bake
