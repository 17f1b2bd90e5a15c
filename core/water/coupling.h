// How a body pushes the water (section 6.3), and how the water gets to know it: all of it goes into the water and, in
// the same way, into the body's own waves.
#pragma once

#include "core/math/vec.h"
#include "core/water/footprint.h"

namespace frm {

/// The water rises where the body takes its place and sinks where the body leaves: heights += change of thickness.
/// Keeps the volume of water, leaves no vortex. `late`: how long after the field's own time this is, times gravity. The
/// field's next step would let the change push for all of its time: what it pushes too much is taken off here.
void displace_water(Footprint& footprint, Field& water, float late = 0);

/// The paper's rule: inside the body the water has the body's velocity. `linear` and `angular` are the body's,
/// `origin` its origin in the footprint's window; the velocity is taken at the height `z` above the body's origin.
void force_velocity(Footprint& footprint, Field& water, const Vec3f& linear, const Vec3f& angular, float z);

/// The push by the pressure on the body's upper side (Eq. 10), for each step, as the footprint's `push` says.
Push push_on_water(const Footprint& footprint);
/// The energy that the water has of all of that push in a step of `dt`, J; to first order.
double energy_of_push(const Footprint& footprint, const Field& water, float dt);
/// The work h dV of what a footprint's thickness changes by in this tick, before the water has it, in cells times m^2, with h
/// the heights as the leapfrog's energy has them: `half_step` (s) before the field's, for its velocities are so old, and with
/// half of the change itself. Leaves them in `heights`, as large as the field's, for the water's cells `around` too.
double work_of_change(const Footprint& footprint, const Field& water, const Rect& around, float half_step,
                      float* heights);
/// Slows the water and the body's own waves, in the cells where it displaces or pushes, until they have `energy` (J) less or
/// stand still. Returns how much less they have. `pull`: gravity times the step, `density` the water's.
double take_energy(Footprint& footprint, Field& water, float pull, float density, double energy);
/// The same push, and the steps, of the body's own waves.
void advance_own(Footprint& footprint, float dt, float gravity, std::uint32_t steps);

/// The body is taken out: the water falls by the body's thickness.
void withdraw_body(Footprint& footprint, Field& water);

}  // namespace frm
