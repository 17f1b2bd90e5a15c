#include "core/water/water.h"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace frm {
namespace {

/// A copy costs as much as a tick (`frm bench`), so while nobody reads they are made ever more rarely: a snapshot is
/// never older than the interval or this share of the time since the last read.
constexpr double unread_share = 0.125;

}  // namespace

Water::Water(const WaterDef& def, std::pmr::memory_resource* memory)
    : field(def.field, memory),
      snapshots(field.cells(), memory),
      def_(def),
      pressure_(field.cells(), 0.0f, memory),
      owed_(field.cells(), 0.0f, memory),
      scratch_(static_cast<std::size_t>(field.stride() * def.field.ny), 0.0f, memory),
      room_(def.field, memory) {}

void Water::set_height(const float* height) {
    field.set_heights(height);
    pay_pressure();
    starts_ = true;
    published_ = false;
}

void Water::set_pressure(const float* pressure, float behind) {
    for (std::size_t k = 0; behind > 0 && k < owed_.size(); ++k)
        owed_[k] += ((pressed_ ? pressure_[k] : 0.0f) - (pressure ? pressure[k] : 0.0f)) * behind;
    owes_ = owes_ || behind > 0;
    pressed_ = pressure != nullptr;
    if (pressed_) std::memcpy(pressure_.data(), pressure, pressure_.size() * sizeof(float));
}

void Water::pay_pressure() {
    if (owes_) std::fill(owed_.begin(), owed_.end(), 0.0f);
    owes_ = false;
}

bool Water::offer_snapshot(std::uint64_t tick, double time) {
    if (snapshots.take_read() || !published_) last_read_ = time;
    const double interval = std::max(static_cast<double>(def_.snapshot_interval), unread_share * (time - last_read_));
    if (published_ && time - last_snapshot_ < interval) return false;
    if (!snapshots.publish(field, tick, time)) return false;
    published_ = true;
    last_snapshot_ = time;
    return true;
}

GridOrigin Water::origin_at(double x, double y) const {
    const auto split = [&](double position, double centre, std::int32_t cells, std::int32_t& whole, float& rest) {
        const double limit = 1e6;
        const double at = (position - centre) / static_cast<double>(def_.field.cell) + 0.5 * cells;
        const double clamped = std::clamp(at, -limit, limit);
        const double floor = std::floor(clamped);
        whole = static_cast<std::int32_t>(floor);
        rest = static_cast<float>(clamped - floor);
    };
    GridOrigin origin;
    split(x, def_.centre_x, def_.field.nx, origin.i, origin.x);
    split(y, def_.centre_y, def_.field.ny, origin.j, origin.y);
    return origin;
}

}  // namespace frm
