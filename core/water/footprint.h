// What one body does to the water, in a window of the water's grid that follows the body: the thickness of the body in
// each column, the pressure on its upper side, and the waves that it made itself.
#pragma once

#include <array>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "core/math/vec.h"
#include "core/water/field.h"
#include "core/water/surface_view.h"

namespace frm {

class Footprint {
public:
    static constexpr int levels = 4;  ///< of grids of thickness, each twice as coarse

    /// `radius`: of a sphere around the body's centre that holds the body, m.
    Footprint(const FieldDef& water, float radius, std::pmr::memory_resource* memory);

    /// Starts a tick: the window follows the body's centre, which is in cell (i, j) of the water.
    /// `water` is where the thickness goes; null where it does not (the paper's rule).
    void begin(std::int32_t i, std::int32_t j, const GridOrigin& body, Field* water);

    /// A wet piece of the surface: corners in the body's local frame, their depths, and its area as seen from above
    /// (n_z times its area). Its share of the displaced volume, minus that area times the mean depth, goes into the
    /// columns around it; over a closed surface the shares add up to the body's thickness. With `spread`, each slice of
    /// the body moves the surface the wider the deeper it is. Keeps the volume.
    void deposit(const Vec3f corner[3], const float depth[3], float area_up, bool spread);
    /// After the last deposit: adds what was laid on coarse levels to thickness().
    void gather();

    /// Pressure p on a horizontal area around a point: a Gaussian of that area's width (section 6.3), wider with
    /// depth, whose sum is p * area.
    void splat_pressure(const Vec3f& at, float pressure, float area, float depth);

    /// The waves that this body made, within the window: what it must not feel as a current (FRM_MODEL_OWN_WAVES).
    Field own;

    std::int32_t i0() const { return i0_; }  ///< the window's first cell in the water
    std::int32_t j0() const { return j0_; }
    std::int32_t size() const { return own.def().nx; }
    const Rect& wet() const { return level_[0].wet; }  ///< cells with thickness in this tick, in the window
    const Rect& wet_before() const { return wet_before_; }
    const Rect& pressed() const { return pressed_; }  ///< cells with pressure in this tick
    /// `own` is not calm, or will not be after this tick's coupling.
    bool active() const { return active_ || !wet().empty() || !wet_before_.empty() || !pressed_.empty(); }
    float* thickness() { return level_[0].thickness.data(); }
    float* thickness_before() { return thickness_before_.data(); }
    float* pressure() { return pressure_.data(); }
    GridOrigin body_in_window() const;

    /// Ends a tick: this tick's thickness is the next one's thickness before.
    void end();
    void hash(StateHash& hash) const;

    bool first = true;  ///< no tick yet: a body that is put into the water makes no splash
    /// How much more of the volume is even over all of the water than in the tick before, in cells times metres.
    double rest_change() const { return rest_ - rest_before_; }
    double rest_before() const { return rest_before_; }
    /// The part of the thickness that went into the water after the body did: what it takes along when it is taken out.
    float deposited_share() const;

private:
    /// One grid of thickness: level k has cells of 2^k cells of the water.
    struct Level {
        std::pmr::vector<float> thickness;
        std::int32_t size = 0;
        Rect wet;
    };
    void shift(std::int32_t di, std::int32_t dj, Field* water);
    void leave_behind(std::int32_t di, std::int32_t dj, Field& water) const;
    static void add(Level& grid, float x, float y, float thickness);
    static void add_coarse(Level& grid, float x, float y, float thickness);

    float cell_;
    std::int32_t i0_ = 0, j0_ = 0;
    GridOrigin body_;
    Rect wet_before_, pressed_;
    bool active_ = false;
    double rest_ = 0, rest_before_ = 0;  ///< volume that is even over all of the water, in cells times metres
    double volume_ = 0;                  ///< of all the thickness before
    double first_volume_ = 0;            ///< of the first tick, which was not put into the water
    std::array<Level, levels> level_;    ///< level 0 is thickness()
    std::pmr::vector<float> thickness_before_, pressure_;
};

}  // namespace frm
