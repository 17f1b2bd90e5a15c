#include "bake/flow/picture.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace frm::bake::flow {
namespace {

constexpr double most_columns = 360;
constexpr int least_block_cells = 16;  // a size; the picture shows the block of about this many

}  // namespace

Picture::Picture(const Domain& domain) : domain_(domain) {
    // The block that holds the near wake and some way around.
    std::size_t shown = 0;
    while (shown + 1 < domain.blocks.size() && domain.bulk / static_cast<double>(2u << shown) >= least_block_cells)
        ++shown;
    const FlowBlock& block = domain.plan.blocks[std::min(shown + 1, domain.blocks.size() - 1)];
    const bool section = domain.finest().periodic;
    for (const int normal : {2, 1}) {
        if (section && normal == 1) continue;
        const int across = 3 - normal;
        FlowSlice slice;
        slice.normal = normal;
        const double wide = block.high.x - block.low.x, high = block.high[across] - block.low[across];
        slice.spacing = std::max(domain.plan.cell, wide / most_columns);
        slice.columns = static_cast<std::uint32_t>(wide / slice.spacing) + 1;
        slice.rows = static_cast<std::uint32_t>(high / slice.spacing) + 1;
        slice.low = block.low;
        // The lattice's origin is the body's middle, to half a cell.
        slice.low[normal] = domain.origin[normal];
        slice.speed.assign(std::size_t{slice.columns} * slice.rows, 0);
        slice.pressure = slice.speed;
        sums_.push_back(std::move(slice));
    }
}

Vec3d Picture::point(const FlowSlice& slice, std::uint32_t row, std::uint32_t column) const {
    Vec3d p = slice.low;
    p.x += column * slice.spacing;
    p[3 - slice.normal] += row * slice.spacing;
    return p;
}

void Picture::add(const Nest& nest) {
    ++count_;
    for (FlowSlice& slice : sums_) {
        for (std::uint32_t row = 0; row < slice.rows; ++row) {
            for (std::uint32_t column = 0; column < slice.columns; ++column) {
                const std::size_t at = std::size_t{row} * slice.columns + column;
                const Vec3d place = (point(slice, row, column) - domain_.origin) / domain_.plan.cell;
                std::array<float, field_count> f{};
                float speed = std::numeric_limits<float>::quiet_NaN(), pressure = speed;
                if (nest.sample(place, f)) {
                    const auto stream = static_cast<float>(domain_.lattice_speed);
                    if (domain_.turning) {  // shown over ground
                        const Vec3d arm = place - domain_.node(0, 0, 0, 0) - domain_.spin_centre;
                        f[1] -= static_cast<float>(domain_.spin.z * arm.y);
                        f[2] += static_cast<float>(domain_.spin.z * arm.x);
                    }
                    speed = std::sqrt(f[1] * f[1] + f[2] * f[2] + f[3] * f[3]) / stream;
                    // Pressure is a third of the density.
                    pressure = f[0] * (2.0f / 3) / (stream * stream);
                }
                slice.speed[at] += speed;
                slice.pressure[at] += pressure;
            }
        }
    }
}

std::vector<FlowSlice> Picture::slices() const {
    std::vector<FlowSlice> means;
    if (count_ == 0) return means;
    means = sums_;
    const float share = 1 / static_cast<float>(count_);
    for (FlowSlice& slice : means) {
        for (float& v : slice.speed) v *= share;
        for (float& v : slice.pressure) v *= share;
    }
    return means;
}

}  // namespace frm::bake::flow
