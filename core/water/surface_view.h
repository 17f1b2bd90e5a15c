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

    /// Depth of a point less `level`: small numbers also for a body that is deep.
    float depth_below_level(const Vec3f& p) const {
        const float wave = field ? field->height_at(origin, p.x * cells_per_metre, p.y * cells_per_metre) : 0.0f;
        return wave - p.z;
    }
    /// Horizontal velocity of the water; u_z is taken as zero (section 6.3).
    Vec3f velocity(const Vec3f& p) const {
        Vec3f v;
        if (field) field->velocity_at(origin, p.x * cells_per_metre, p.y * cells_per_metre, v.x, v.y);
        return v;
    }
};

}  // namespace frm
