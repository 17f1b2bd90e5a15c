// The water surface as one body sees it: in the body's local frame (world axes, origin at the body), in float.
#pragma once

#include "core/math/vec.h"
#include "core/water/field.h"

namespace frm {

struct SurfaceView {
    bool everywhere = false;       ///< fluid without a surface: all is wet and nothing is buoyant
    float level = 0;               ///< of the calm surface above the body's origin, m
    const Field* field = nullptr;  ///< null: flat
    bool still = true;             ///< the water near the body is at rest
    GridOrigin origin;             ///< the body's origin in the field
    float cells_per_metre = 0;
    float fastest = 0;  ///< sqrt(gravity * depth): bodies do not feel water run faster than waves do, m/s
    /// The field is of `ahead` seconds ago (FRM_SKIP_WAVE_STEPS); heights and velocities go on as Eqs. 7 and 8 say.
    float ahead = 0;
    bool waits = false;                  ///< nothing is done to the water in this tick
    float rise = 0, bend = 0, pull = 0;  ///< of that time: see Field::heights_ahead, pull_at
    /// Where the tick takes several steps: their number, and length, s. Heights are the mean of those that they begin with.
    std::uint32_t steps = 1;
    float step = 0, gravity = 0;
    float later = 0;           ///< and by so much of a step later
    float* scratch = nullptr;  ///< as large as the field's heights
    Field::Room* room = nullptr;

    /// Horizontal velocity of the water; u_z is taken as zero (section 6.3).
    Vec3f velocity(const Vec3f& p) const {
        Vec3f v;
        if (!field) return v;
        const float x = p.x * cells_per_metre, y = p.y * cells_per_metre;
        field->velocity_at(origin, x, y, v.x, v.y);
        if (pull > 0) {
            Vec3f more;
            field->pull_at(origin, x, y, pull, more.x, more.y);
            v += more;
        }
        return v;
    }
};

}  // namespace frm
