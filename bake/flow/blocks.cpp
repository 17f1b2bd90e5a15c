#include "bake/flow/blocks.h"

#include <algorithm>
#include <cmath>

namespace frm::bake::flow {
namespace {

/// Room round the body, in its sizes (root of the projected area; a section's height).
struct Room {
    double ahead, beside, behind;

    Room operator*(double s) const { return {ahead * s, beside * s, behind * s}; }
};

// The wake decides the drag of a blunt body, and wants some twenty cells a size for two sizes behind it: with the
// border at half a size beside and one behind, at 16 cells a size, the drag of a cube at Re 1e4 was 8 % under that of a
// grid without borders near; with these 1 to 2 %. Cells that are finer still only serve the layer on the wall.
// A slab's wake closes late: with the border 4 heights behind, not 10, a plate across the stream at Re 1e4 shed a tenth
// too fast.
constexpr Room wall_layer{0.12, 0.15, 0.3}, wake{0.4, 0.5, 2}, wake_section{0.6, 1.0, 4}, wake_slab{0.6, 1.0, 10};
// The layers that leave the front edges of a section stay up to 0.6 heights off its side, and roll up within 1.5 behind
// it: that is where a slab's cells count.
constexpr Room near_slab{0.3, 0.6, 1.5};
constexpr double most_in_wake = 36, most_in_wake_slab = 24;  // cells a size
// Far away blockage is 0.2 %. In two dimensions a body is felt much farther.
constexpr Room far_away{8, 10, 14}, far_section{30, 30, 40};
// Cells a size in the coarsest block.
constexpr double coarsest = 1.0, coarsest_section = 0.75;
constexpr int least_cells = 8, least_gap = 6;  // room of the finest block; from one block's border to the next
constexpr double most_cells = 1e6;

double between(double inner, double outer, double share) { return inner * std::pow(outer / inner, share); }

Room room(int level, int levels, int wake_level, bool section, bool slab) {
    if (slab && level + 1 == wake_level) return near_slab;
    if (level < wake_level) return wall_layer * (1 << level);
    const double share =
        levels - 1 > wake_level ? static_cast<double>(level - wake_level) / (levels - 1 - wake_level) : 1.0;
    const Room inner = slab ? wake_slab : section ? wake_section : wake, outer = section ? far_section : far_away;
    return {between(inner.ahead, outer.ahead, share), between(inner.beside, outer.beside, share),
            between(inner.behind, outer.behind, share)};
}

// Blocks that turn with the body, in its largest distance from the axis: beside from the axis, along it from the body.
// In the turning frame the water far away is the faster the farther, so there is no room for ten sizes. What other
// boxes do to the torque is in docs/flow.md.
struct TurningRoom {
    double beside, along;
};
constexpr TurningRoom swirl{1.4, 0.4}, turning_far{3.5, 2};
constexpr double coarsest_radius = 5, swirl_radius = 12;  // least cells a radius, far away and where the wakes go round

int turning_block_count(double radius) {
    return 1 + std::clamp(static_cast<int>(std::floor(std::log2(radius / coarsest_radius))), 0, 12);
}

/// What a block that turns should hold, before borders.
void turning_box(const BlockRequest& q, int level, int levels, Vec3d& low, Vec3d& high) {
    int swirl_level = 0;
    while (swirl_level + 1 < levels && q.radius / (2 << swirl_level) >= swirl_radius) ++swirl_level;
    if (level < swirl_level) {
        const Room space = wall_layer * (1 << level) * q.bulk;
        const double margin = space.beside;
        low = q.low - Vec3d{margin, margin, margin};
        high = q.high + Vec3d{margin, margin, margin};
        return;
    }
    const double share =
        levels - 1 > swirl_level ? static_cast<double>(level - swirl_level) / (levels - 1 - swirl_level) : 1.0;
    const double beside = q.radius * between(swirl.beside, turning_far.beside, share);
    const double along = q.radius * between(swirl.along, turning_far.along, share);
    low = {q.axis.x - beside, q.axis.y - beside, q.low.z - along};
    high = {q.axis.x + beside, q.axis.y + beside, q.high.z + along};
}

}  // namespace

int block_count(double bulk, bool section) {
    const double levels = std::floor(std::log2(bulk / (section ? coarsest_section : coarsest)));
    return 1 + std::clamp(static_cast<int>(levels), 0, 12);
}

std::vector<Block> plan_blocks(const BlockRequest& q) {
    const int levels = q.radius > 0 ? turning_block_count(q.radius) : block_count(q.bulk, q.section);
    const bool slab = q.section && q.layers > 1;
    const double most = slab ? most_in_wake_slab : most_in_wake;
    int wake_level = 0;
    while (wake_level + 1 < levels && q.bulk / (1 << wake_level) > most) ++wake_level;
    std::vector<Block> blocks(static_cast<std::size_t>(levels));
    Vec3d low = q.low, high = q.high;  // of what a block must hold: the body, then the last block
    for (int l = 0; l < levels; ++l) {
        const double cell = 1 << l, gap = (l == 0 ? least_cells : least_gap) * cell;
        Room space = room(l, levels, wake_level, q.section, slab) * q.bulk;
        if (q.still) space.behind = space.ahead;
        Vec3d wanted_low = q.low - Vec3d{space.ahead, space.beside, space.beside};
        Vec3d wanted_high = q.high + Vec3d{space.behind, space.beside, space.beside};
        if (q.radius > 0) turning_box(q, l, levels, wanted_low, wanted_high);
        Block& block = blocks[static_cast<std::size_t>(l)];
        block.grid.periodic = q.section;
        for (int axis = 0; axis < 3; ++axis) {
            int& first = block.first[static_cast<std::size_t>(axis)];
            int count = 0;
            if (axis == 2 && q.section) {
                first = 0;
                count = q.layers == 1 ? 1 : q.layers >> l;
            } else {
                const double from = std::min(wanted_low[axis], low[axis] - gap);
                const double to = std::max(wanted_high[axis], high[axis] + gap);
                if (!(to - from < most_cells * cell)) {
                    throw BakeError(
                        "flow: the body is more than a million cells long; lower resolution, or raise "
                        "reference_length");
                }
                // Ghosts lie on nodes of the coarser block. Rows fill whole cache lines.
                constexpr int lanes = static_cast<int>(Grid::lanes);
                const int a = static_cast<int>(std::floor(from / (2 * cell)));
                int b = static_cast<int>(std::ceil(to / (2 * cell)));
                if (axis == 0) b = a + (b - a + lanes / 2) / (lanes / 2) * (lanes / 2) - 1;
                first = 2 * a + 1;
                count = 2 * (b - a) - 1;
                low[axis] = 2 * a * cell;
                high[axis] = 2 * b * cell;
            }
            (axis == 0 ? block.grid.nx : axis == 1 ? block.grid.ny : block.grid.nz) = count;
        }
    }
    return blocks;
}

}  // namespace frm::bake::flow
