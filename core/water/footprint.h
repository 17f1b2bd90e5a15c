// What one body does to the water, in a window of the water's grid that follows the body: the thickness of the body in
// each column, the pressure on its upper side, and the waves that it made itself.
#pragma once

#include <cstdint>
#include <memory_resource>

#include "core/math/vec.h"
#include "core/water/aligned_floats.h"
#include "core/water/field.h"
#include "core/water/pyramid.h"
#include "core/water/surface_view.h"

namespace frm {

/// What moves slowly at depth z below the surface moves the surface as K(r) = z / (2 pi (r^2 + z^2)^(3/2)) does (a
/// source under a free surface at small Froude number, by its image), half of it within r = 1.73 z. A Gaussian of this
/// many depths does the same.
constexpr float widths_per_depth = 1.47f;

class Footprint {
public:
    /// `radius`: of a sphere around the body's centre that holds the body, m; `volume`: the body's, m^3.
    Footprint(const FieldDef& water, float radius, double volume, std::pmr::memory_resource* memory);

    /// Starts a tick: the window follows the body's centre, which is in cell (i, j) of the water.
    /// `water` is where the thickness goes; null where it does not (the paper's rule).
    void begin(std::int32_t i, std::int32_t j, const GridOrigin& body, Field* water);

    /// Lays a part of the body's thickness around a point, in cells of the water from the body's origin: a spline as wide as
    /// `level` of the pyramid asks for, whose sum is `amount` (cells of area times metres). What falls outside the window
    /// counts as left().
    void deposit(int level, float x, float y, float amount);
    /// The part of the thickness that is spread so wide that it counts as even over all of the water.
    void leave(double amount) { rest_ += amount; }
    /// Only this share of the volume's horizontal extent lies over the water: what is left counts no further.
    void keep_over_water(float share) { rest_ *= static_cast<double>(share); }
    /// After the last deposit.
    void gather();
    /// So deep that of what is pushed or displaced `shallowest` under the calm surface, m, less than `deep_share` is seen
    /// at the surface.
    bool is_deep(float shallowest) const;
    static constexpr float deep_share = 0.001f;
    /// Instead of deposits: the thickness is still that of the tick before.
    void keep();

    /// Pressure p on a horizontal area around a point: a Gaussian of that area's width (section 6.3), wider with
    /// depth, whose sum is p * area.
    void splat_pressure(const Vec3f& at, float pressure, float area, float depth);
    /// After the last splat. No more than `most` presses or sucks anywhere, Pa: as much as lifts the water by its depth.
    void gather_pressure(float most = 3e38f);

    /// The waves that this body made, within the window: what it must not feel as a current (FRM_MODEL_OWN_WAVES).
    Field own;

    std::int32_t i0() const { return i0_; }  ///< the window's first cell in the water
    std::int32_t j0() const { return j0_; }
    std::int32_t size() const { return own.def().nx; }
    int levels() const { return thickness_.levels(); }    ///< of what is laid
    float cell() const { return cell_; }                  ///< m
    const Rect& wet() const { return thickness_.wet(); }  ///< cells with thickness in this tick, in the window
    const Rect& wet_before() const { return wet_before_; }
    const Rect& pressed() const { return pressure_.wet(); }  ///< cells with pressure in this tick
    bool kept() const { return kept_; }
    /// The thickness is not that of the tick before.
    bool changed() const { return !kept_ && !(wet().empty() && wet_before_.empty() && rest_ == rest_before_); }
    /// `own` is not calm, or will not be after this tick's coupling.
    bool active() const { return active_ || !wet().empty() || !wet_before_.empty() || !pressed().empty(); }
    const Pyramid& thickness() const { return thickness_; }
    const float* thickness_before_row(std::int32_t j) const {
        return thickness_before_.data() + static_cast<std::ptrdiff_t>(j) * size();
    }
    const float* pressure() const { return pressure_.data(); }
    const GridOrigin& body() const { return body_; }  ///< its origin in the water
    GridOrigin body_in_window() const;

    /// Ends a tick: this tick's thickness is the next one's thickness before.
    void end();
    void hash(StateHash& hash) const;

    float push = 0;     ///< of this tick's pressure: what each step adds for its gradient (Push::factor)
    bool first = true;  ///< no tick yet: a body that is put into the water makes no splash
    /// How much more of the volume is even over all of the water than in the tick before, in cells times metres.
    double rest_change() const { return kept_ ? 0.0 : rest_ - rest_before_; }
    double rest_before() const { return rest_before_; }
    /// The part of the thickness that went into the water after the body did: what it takes along when it is taken out.
    float deposited_share() const;
    /// The water's heights are a host's: what the body displaces by now is in them, as before its first tick.
    void count_as_given() { first_volume_ = volume_; }

private:
    Footprint(const FieldDef& water, float radius, int levels, std::pmr::memory_resource* memory);
    void shift(std::int32_t di, std::int32_t dj, Field* water);
    void leave_behind(std::int32_t di, std::int32_t dj, Field& water) const;
    void splat_wide(float x, float y, float width, float amount);

    float cell_;
    std::int32_t i0_ = 0, j0_ = 0;
    GridOrigin body_;
    float base_x_ = 0, base_y_ = 0;  ///< the body's origin in the window, cells
    Rect wet_before_;
    bool active_ = false, kept_ = false;
    double laid_ = 0;                    ///< volume of the thickness, in cells times metres
    double rest_ = 0, rest_before_ = 0;  ///< volume that is even over all of the water
    double volume_ = 0;                  ///< of all the thickness before
    double first_volume_ = 0;            ///< of the first tick, which was not put into the water; or of set heights
    Pyramid thickness_, pressure_;
    AlignedFloats thickness_before_;
};

}  // namespace frm
