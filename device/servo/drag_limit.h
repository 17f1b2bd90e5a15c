// How much of a body's drag a grip can be made to feel by a sampled loop, and the rest of it late instead of too strong.
//
// Drag is a damper D to small motion. One that is sampled with period T and held drives a mass M beyond about M / (2 T)
// (less by what comes late; docs/haptic-stability.md). A grip is light, and a blade a metre away from it makes of 60 N s/m a
// damper of 60 N m s/rad against an inertia of 1e-4 kg m^2: no rate that a device has bears that. What does is to feel the
// body as through a spring and a damper that the grip bears (virtual coupling: Colgate, Stanley and Brown, "Issues in the
// haptic display of tool use", IROS 1995): quick motion meets the damper M / (4 T) at most, and the force settles to all of
// the drag by the time that it takes the spring, in proportion to what is too much. Directions in which the grip bears all
// are left as they are.
#pragma once

#include <array>

#include "core/body/body.h"

namespace frm::device {

/// Six by six, row after row, as Coefficients::damping.
using Matrix6 = std::array<double, 36>;

/// The same about another point: `arm` from it to the old one.
Matrix6 about(const Vec3d& arm, const Matrix6& damping);

class DragLimit {
public:
    /// Of the grip, by what the host scales: force times length of motion, over mass; torque over inertia.
    struct Grip {
        double linear = 0, angular = 0;
    };

    /// Begins with the next wrench.
    void reset() { begun_ = false; }
    /// What of `wrench` is to be displayed next, `dt` seconds after the last, with the damping about the same point.
    Wrench limit(const Wrench& wrench, const Matrix6& damping, double dt, const Grip& grip);
    /// The largest of damping over what is borne, in the last call; up to 1 nothing was done.
    double excess() const { return excess_; }

private:
    std::array<double, 6> slow_{};
    double excess_ = 0;
    bool begun_ = false;
};

}  // namespace frm::device
