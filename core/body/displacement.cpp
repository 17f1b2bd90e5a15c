#include <algorithm>
#include <cmath>

#include "core/body/body.h"
#include "core/kernels/kernels.h"

namespace frm {
namespace {

/// Deeper than this many cells of width, what the middle keeps (2e-5 of it) is left out with the rest.
constexpr float deepest = 2000;
/// A body of which no point has moved more than this part of a cell has the thickness that it had.
constexpr float still = 1e-3f;

/// No point of the body has moved by a still part of a cell since its thickness was laid.
bool has_stayed(const Body& body, float cell) {
    const Vec3d moved = body.def.pose.position - body.laid_at;
    const Vec3f a = body.rotation.row0 - body.laid_rotation.row0, b = body.rotation.row1 - body.laid_rotation.row1,
                c = body.rotation.row2 - body.laid_rotation.row2;
    const Clusters& clusters = body.def.map->clusters;
    const float reach = (length(clusters.centre) + clusters.radius) * body.def.scale;
    const float turned = std::sqrt(dot(a, a) + dot(b, b) + dot(c, c)) * reach;
    return length(moved) + static_cast<double>(turned) < static_cast<double>(still * cell);
}

/// All of the body's volume, in cells times metres.
double volume_of(const Body& body, float cell) {
    const auto scale = static_cast<double>(body.def.scale), per_cell = 1 / static_cast<double>(cell);
    return body.def.map->shape.volume * scale * scale * scale * per_cell * per_cell;
}

}  // namespace

void leave_displacement(Body& body) {
    body.account->forget();
    body.laid_at = body.def.pose.position;
    body.laid_rotation = body.rotation;
    body.footprint->leave(volume_of(body, body.footprint->cell()));
}

// The clip is against the calm surface, not the waves: the linear theory of Eqs. 7 and 8 takes what pushes the water
// at its mean place. Against the waves, a column that the body pierces would be thicker where the water is higher and
// so raise the water again: beside a box at rest in 0.4 m of water a ripple of 1 mm then grew to 0.35 m in two
// seconds.
void lay_displacement(Body& body, float level, bool spread, bool keep_still) {
    Footprint& footprint = *body.footprint;
    const float cell = footprint.cell(), scale = body.def.scale;
    if (keep_still && spread && !footprint.first && has_stayed(body, cell)) return footprint.keep();
    body.laid_at = body.def.pose.position;
    body.laid_rotation = body.rotation;

    const Clusters& clusters = body.def.map->clusters;
    const VolumeElements& elements = *body.elements;
    const Rotation<float>& turn = body.rotation;
    const Vec3f arm = turn.to_world(clusters.centre * scale);
    const float depth = level - arm.z, reach = clusters.radius * scale;
    if (depth <= -reach) return;
    const float per_cell = 1 / cell, to_cells = scale * per_cell;
    // In the map's lengths, volumes become cells times metres by this.
    const float to_amount = scale * scale * scale * (per_cell * per_cell);
    SliceLevel slice{1, 0, 0, spread ? 1.0f : 0.0f, to_cells * (widths_per_depth / Pyramid::width_of_spline)};
    if (spread && (depth - reach) / scale * slice.width > deepest) return footprint.leave(volume_of(body, cell));

    const Kernels& kernel = kernels();
    const float centre_depth = depth / scale, x0 = arm.x * per_cell, y0 = arm.y * per_cell;
    const Vec3f along_x = turn.row0 * to_cells, along_y = turn.row1 * to_cells, &up = turn.row2;
    const int last = spread ? footprint.levels() - 1 : elements.finest();
    double left_over = 0;
    for (int k = elements.finest(); k <= last; ++k) {
        slice.cell = static_cast<float>(1 << k);
        slice.finest = k == elements.finest() ? 1.0f : 0.0f;
        slice.widest = k == footprint.levels() - 1 ? 1.0f : 0.0f;
        // Slices of this level lie between these depths.
        const float from = slice.finest > 0 || !spread ? 0.0f : 0.5f * slice.cell / slice.width;
        const float to = slice.widest > 0 || !spread ? 3e38f : 2 * slice.cell / slice.width;
        for (const VolumeElements::Block& block : elements.at(k)) {
            const float middle =
                centre_depth - (up.x * block.centre[0] + up.y * block.centre[1] + up.z * block.centre[2]);
            const float half = std::fabs(up.x) * block.half[0] + std::fabs(up.y) * block.half[1] +
                               std::fabs(up.z) * block.half[2] + 0.03f / slice.width;
            if (middle + half <= from || middle - half >= to) continue;
            alignas(64) float laid[kernel_lanes], left[kernel_lanes];
            kernel.slice_elements(&block.element, &slice, centre_depth, up.x, up.y, up.z, laid, left);
            if (slice.widest > 0)  // the other levels leave nothing
                for (const float part : left) left_over += static_cast<double>(part);
            for (std::size_t e = 0; e < kernel_lanes; ++e) {
                if (!(laid[e] > 0)) continue;
                const Vec3f at(block.element.x[e], block.element.y[e], block.element.z[e]);
                footprint.deposit(k, x0 + dot(along_x, at), y0 + dot(along_y, at), laid[e] * to_amount);
            }
        }
    }
    footprint.leave(left_over * static_cast<double>(to_amount));
    footprint.gather();
}

void charge_displacement(Body& body, const Field& water, const GridOrigin& origin, float level, float weight, float dt,
                         float half_step, float* scratch) {
    if (body.footprint->kept()) return body.account->stay();
    if (!body.footprint->changed()) return body.account->forget();
    const float cell = water.def().cell, scale = body.def.scale;
    const Vec3f& up = body.rotation.row2;
    const Immersion now{placement(body, origin, 1 / cell), up, level / scale - dot(up, body.def.map->clusters.centre)};
    body.account->charge(*body.footprint, water, now, scale / cell, weight, dt, half_step, scratch);
}

}  // namespace frm
