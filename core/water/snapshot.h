// Copies of the water for other threads. The ticking thread writes a slot that nobody reads and then names it the
// newest; a reader counts itself in, checks that its slot is still the newest, and copies. Neither ever waits for the
// other.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory_resource>
#include <vector>

#include "core/water/field.h"

namespace frm {

struct WaterSnapshot {
    WaterSnapshot(std::size_t cells, std::pmr::memory_resource* memory)
        : height(cells, 0.0f, memory), velocity_x(cells, 0.0f, memory), velocity_y(cells, 0.0f, memory) {}

    std::uint64_t tick = 0;
    double time = 0;
    std::pmr::vector<float> height, velocity_x, velocity_y;  ///< at cell centres
};

class SnapshotExchange {
public:
    SnapshotExchange(std::size_t cells, std::pmr::memory_resource* memory);

    /// [realtime] Skipped, with false, while readers hold every other slot.
    bool publish(const Field& field, std::uint64_t tick, double time);

    /// Whether somebody has read since this was asked last.
    bool take_read() { return read_.load(std::memory_order_relaxed) && read_.exchange(false); }

    /// [any] Calls `use(const WaterSnapshot&)` on the newest snapshot.
    template <typename Use>
    void read(Use&& use) {
        read_.store(true);
        Slot& slot = acquire();
        use(static_cast<const WaterSnapshot&>(slot.snapshot));
        slot.readers.fetch_sub(1);
    }

private:
    struct Slot {
        Slot(std::size_t cells, std::pmr::memory_resource* memory) : snapshot(cells, memory) {}

        WaterSnapshot snapshot;
        std::atomic<std::int32_t> readers{0};
    };

    Slot& acquire();

    std::array<Slot, 4> slots_;
    std::atomic<std::uint32_t> newest_{0};
    std::atomic<bool> read_{false};
};

/// Averages the face velocities to cell centres and copies the heights, none lower than the bed; arrays of field.cells()
/// floats, each may be null.
void copy_to_centres(const Field& field, float* height, float* velocity_x, float* velocity_y);

}  // namespace frm
