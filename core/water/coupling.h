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
/// The share of that push which the water takes: all of it, but no more energy in a step of `dt` than `work`, J, that the
/// body's drag does on the water in it. The push follows from the velocity that the water has, so that a body would else
/// drive the waves it meets, one at rest too.
float share_of_push(const Footprint& footprint, const Field& water, float dt, double work);
/// The same push, and the steps, of the body's own waves.
void advance_own(Footprint& footprint, float dt, float gravity, std::uint32_t steps);

/// The body is taken out: the water falls by the body's thickness.
void withdraw_body(Footprint& footprint, Field& water);

}  // namespace frm
