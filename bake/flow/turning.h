// The frame that turns with the body about the z axis of the lattice: what the fluid in it gains a step from Coriolis'
// and the centrifugal force, and the far field, which stands still and so goes round the other way.
#pragma once

#include <cstddef>

#include "bake/flow/collision.h"

namespace frm::bake::flow {

/// Of one block and one of its steps, in its cells and steps. Half of a step's force belongs to the velocity that the
/// force depends on (Guo, Zheng & Shi 2002, Phys. Rev. E 65, 046308): with u = v + F/2, v what the populations carry
/// before the collision and v + F what they carry after it, the scheme is of second order, and F follows from v by
/// (1 + w x) F = -2 w x v - w x (w x r) - dw x r. Water at rest, u = -w x r, then feels exactly what its circles want.
struct Turning {
    float rate = 0;                ///< w, radians in the middle of the step
    float change = 0;              ///< dw, what w gains in the step
    float axis_x = 0, axis_y = 0;  ///< node coordinates of the axis in the block

    bool on() const { return rate != 0 || change != 0; }

    /// Water at rest.
    float far_x(float y) const { return rate * (y - axis_y); }
    float far_y(float x) const { return -rate * (x - axis_x); }

    /// What velocity gains in a step, from the velocity in its middle.
    FRM_FLOW_INLINE float gain_x(float uy, float x, float y) const {
        return rate * (2 * uy + rate * (x - axis_x)) + change * (y - axis_y);
    }
    FRM_FLOW_INLINE float gain_y(float ux, float x, float y) const {
        return rate * (rate * (y - axis_y) - 2 * ux) - change * (x - axis_x);
    }

    /// The same from the velocity before the step.
    struct Kick {
        float x, y;
    };
    FRM_FLOW_INLINE Kick kick(float vx, float vy, float x, float y) const {
        const float gx = gain_x(vy, x, y), gy = gain_y(vx, x, y), share = 1 / (1 + rate * rate);
        return {share * (gx + rate * gy), share * (gy - rate * gx)};
    }
};

/// Cells one after the other: the first one's place and the way from each to the next.
struct Line {
    float x = 0, y = 0, step_x = 1, step_y = 0;
};

/// Velocities before the collision become those in the middle of the step, and from there those after it.
void to_middle(const Turning& turning, const Line& cells, std::size_t count, float* ux, float* uy);
void from_middle(const Turning& turning, const Line& cells, std::size_t count, float* ux, float* uy);

}  // namespace frm::bake::flow
