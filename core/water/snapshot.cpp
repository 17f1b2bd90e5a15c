#include "core/water/snapshot.h"

#include <algorithm>

namespace frm {

SnapshotExchange::SnapshotExchange(std::size_t cells, std::pmr::memory_resource* memory)
    : slots_{{{cells, memory}, {cells, memory}, {cells, memory}, {cells, memory}}} {}

bool SnapshotExchange::publish(const Field& field, std::uint64_t tick, double time) {
    const std::uint32_t newest = newest_.load();
    for (std::uint32_t i = 0; i < slots_.size(); ++i) {
        Slot& slot = slots_[i];
        if (i == newest || slot.readers.load() != 0) continue;
        slot.snapshot.tick = tick;
        slot.snapshot.time = time;
        copy_to_centres(field, slot.snapshot.height.data(), slot.snapshot.velocity_x.data(),
                        slot.snapshot.velocity_y.data());
        newest_.store(i);
        return true;
    }
    return false;
}

// A reader that counted itself into a slot just before the writer took it sees that the slot is not the newest any
// more, and looks again: the writer only ever takes slots that are not the newest.
SnapshotExchange::Slot& SnapshotExchange::acquire() {
    for (;;) {
        const std::uint32_t newest = newest_.load();
        Slot& slot = slots_[newest];
        slot.readers.fetch_add(1);
        if (newest_.load() == newest) return slot;
        slot.readers.fetch_sub(1);
    }
}

void copy_to_centres(const Field& field, float* height, float* velocity_x, float* velocity_y) {
    const std::int32_t nx = field.def().nx, ny = field.def().ny;
    if (height) {
        field.copy_heights(height);
        const float bed = -field.def().depth;
        for (std::size_t i = 0; i < field.cells(); ++i) height[i] = std::max(height[i], bed);
    }
    for (std::int32_t j = 0; j < ny; ++j) {
        const std::size_t row = static_cast<std::size_t>(j) * static_cast<std::size_t>(nx);
        const float *u = field.velocity_x_row(j), *v = field.velocity_y_row(j), *above = field.velocity_y_row(j + 1);
        if (velocity_x)
            for (std::int32_t i = 0; i < nx; ++i)
                velocity_x[row + static_cast<std::size_t>(i)] = 0.5f * (u[i] + u[i + 1]);
        if (velocity_y)
            for (std::int32_t i = 0; i < nx; ++i)
                velocity_y[row + static_cast<std::size_t>(i)] = 0.5f * (v[i] + above[i]);
    }
}

}  // namespace frm
