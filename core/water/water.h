// A world's water: the field, what the host presses on it, and the snapshots for other threads.
#pragma once

#include <memory_resource>
#include <utility>
#include <vector>

#include "core/water/field.h"
#include "core/water/snapshot.h"

namespace frm {

struct WaterDef {
    FieldDef field;
    double centre_x = 0, centre_y = 0;    ///< m
    float snapshot_interval = 1.0f / 60;  ///< s
};

class Water {
public:
    Water(const WaterDef& def, std::pmr::memory_resource* memory);

    const WaterDef& def() const { return def_; }
    Field field;
    SnapshotExchange snapshots;

    void set_height(const float* height);
    /// True once after set_height: the next step starts from rest.
    bool take_start() { return std::exchange(starts_, false); }
    bool starts() const { return starts_; }
    /// Null takes the pressure away. The water was last stepped `behind` s ago: so long the old one has pressed, and the next
    /// step, which the new one pushes for all of its time, owes the difference.
    void set_pressure(const float* pressure, float behind);
    /// Null while the host presses nowhere.
    const float* pressure() const { return pressed_ ? pressure_.data() : nullptr; }
    /// Pa s; null where nothing is owed.
    const float* owed_pressure() const { return owes_ ? owed_.data() : nullptr; }
    void pay_pressure();

    /// As many floats as the field's heights take, for whoever is at work on a tick (SurfaceView::scratch).
    float* scratch() { return scratch_.data(); }
    Field::Room& room() { return room_; }

    /// Publishes a snapshot when the interval has passed, or a longer one while nobody reads them; whether it did.
    bool offer_snapshot(std::uint64_t tick, double time);

    /// Where a horizontal position lies in the grid. Positions more than a million cells outside are moved nearer: all
    /// is flat there.
    GridOrigin origin_at(double x, double y) const;

private:
    WaterDef def_;
    double last_snapshot_ = 0, last_read_ = 0;  ///< s
    bool published_ = false, pressed_ = false, owes_ = false, starts_ = false;
    std::pmr::vector<float> pressure_, owed_, scratch_;
    Field::Room room_;
};

}  // namespace frm
