#include "bake/flow/blocks.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace frm::bake::flow {
namespace {

double env(const char* n, double d) { const char* s = std::getenv(n); return s ? std::atof(s) : d; }

/// Room round the body, in its sizes, in the finest block and in the coarsest; between them it grows geometrically.
struct Room {
    double ahead, beside, behind;
};
constexpr Room near_section{0.6, 0.8, 2.5}, far_section{30, 30, 40};
// Cells over the body's size in the coarsest block.
constexpr double coarsest = 1.0, coarsest_section = 0.75;
constexpr int least_cells = 6, least_gap = 4;  // room of the finest block; from one block's border to the next
constexpr double most_cells = 1e6;

double between(double inner, double outer, double share) { return inner * std::pow(outer / inner, share); }

}  // namespace

int block_count(double bulk, bool section) {
    const double levels = std::floor(std::log2(bulk / (section ? coarsest_section : env("COARSEST", coarsest))));
    return 1 + std::clamp(static_cast<int>(levels), 0, 12);
}

std::vector<Block> plan_blocks(const BlockRequest& q) {
    const int levels = block_count(q.bulk, q.section);
    const Room near_body{env("AHEAD0", 0.4), env("BESIDE0", 0.5), env("BEHIND0", 2)}, tight{env("AHEADT", 0.12), env("BESIDET", 0.15), env("BEHINDT", 0.3)},
        far_away{env("AHEAD", 8), env("BESIDE", 10), env("BEHIND", 14)};
    const Room inner = q.section ? near_section : near_body, outer = q.section ? far_section : far_away;
    std::vector<Block> blocks(static_cast<std::size_t>(levels));
    int wake = 0;
    while (wake + 1 < levels && q.bulk / (1 << wake) > env("WAKE", 36)) ++wake;
    // Bounds asked for, in finest cells; each block holds the last one and a gap.
    Vec3d low = q.low, high = q.high;
    for (int l = 0; l < levels; ++l) {
        const double cell = 1 << l;
        const bool skin = l < wake;
        const double share = levels - 1 > wake ? static_cast<double>(l - wake) / (levels - 1 - wake) : 1.0;
        const double gap = (l == 0 ? least_cells : least_gap) * cell;
        const double ahead = q.bulk * (skin ? tight.ahead * (l + 1) : between(inner.ahead, outer.ahead, share));
        const double behind = q.still ? ahead : q.bulk * (skin ? tight.behind * (l + 1) : between(inner.behind, outer.behind, share));
        const double beside = q.bulk * (skin ? tight.beside * (l + 1) : between(inner.beside, outer.beside, share));
        const Vec3d room_low{ahead, beside, beside}, room_high{behind, beside, beside};
        Block& block = blocks[static_cast<std::size_t>(l)];
        block.grid.periodic = q.section;
        const bool last = l + 1 == levels;
        for (int axis = 0; axis < 3; ++axis) {
            int& first = block.first[static_cast<std::size_t>(axis)];
            int count = 0;
            if (axis == 2 && q.section) {
                first = 0;
                count = q.layers == 1 ? 1 : q.layers >> l;
            } else {
                const double from = std::min(q.low[axis] - room_low[axis], low[axis] - gap);
                const double to = std::max(q.high[axis] + room_high[axis], high[axis] + gap);
                if (!(to - from < most_cells * cell)) throw BakeError("flow: the body is too long for its cells");
                // Ghosts lie on nodes of the coarser block. Rows fill whole cache lines.
                const int a = static_cast<int>(std::floor(from / (2 * cell)));
                int b = static_cast<int>(std::ceil(to / (2 * cell)));
                const int lanes = static_cast<int>(Grid::lanes);
                if (axis == 0) b = a + (b - a + 1 + lanes / 2 - 1) / (lanes / 2) * (lanes / 2) - 1;
                first = 2 * a + 1;
                count = 2 * (b - a) - 1;
                if (last && axis == 0) ++count;
                low[axis] = 2 * a * cell;
                high[axis] = 2 * b * cell;
            }
            (axis == 0 ? block.grid.nx : axis == 1 ? block.grid.ny : block.grid.nz) = count;
        }
    }
    return blocks;
}

}  // namespace frm::bake::flow
