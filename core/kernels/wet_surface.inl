// The wet surface: the water sampled at clusters, planes through it, triangles clipped against them. Every lane does the
// same, chosen by selects, so that a lane's result does not depend on how many the machine does at once.

/// Heights at `count` points given in the body's frame, at most 64: bilinear between cells, the outermost cell's beyond
/// their middle, zero outside. Neighbours in a row are fetched together, for all points before the first is used: left to
/// compilers it is four loads and as many insertions for each.
static void sample_heights(const HeightGrid* grid, const GridPlacement* at, const float* x, const float* y,
                           const float* z, std::size_t count, float* __restrict out) {
    constexpr std::size_t most = 4 * kernel_lanes;
    const std::int32_t nx = grid->nx, ny = grid->ny, base_i = at->i, base_j = at->j;
    const auto stride = static_cast<std::int32_t>(grid->stride);
    const float* height = grid->height;
    const float level = grid->level;
    const float ax = at->along_x[0], bx = at->along_x[1], cx = at->along_x[2], ox = at->x;
    const float ay = at->along_y[0], by = at->along_y[1], cy = at->along_y[2], oy = at->y;
    const float wide = static_cast<float>(nx), high = static_cast<float>(ny);
    alignas(64) std::int32_t place[most], inside[most];
    alignas(64) float along[most], across[most], below[2 * most], above[2 * most];
    for (std::size_t k = 0; k < count; ++k) {
        const float gx = ox + (ax * x[k] + bx * y[k] + cx * z[k]), gy = oy + (ay * x[k] + by * y[k] + cy * z[k]);
        const float px = static_cast<float>(base_i) + gx, py = static_cast<float>(base_j) + gy;
        const float fx = gx - 0.5f, fy = gy - 0.5f;
        const std::int32_t tx = static_cast<std::int32_t>(fx), ty = static_cast<std::int32_t>(fy);
        const std::int32_t wx = tx - (static_cast<float>(tx) > fx ? 1 : 0);
        const std::int32_t wy = ty - (static_cast<float>(ty) > fy ? 1 : 0);
        std::int32_t i = base_i + wx, j = base_j + wy;
        float s = fx - static_cast<float>(wx), t = fy - static_cast<float>(wy);
        s = i < 0 ? 0.0f : s, t = j < 0 ? 0.0f : t;
        i = i < 0 ? 0 : i, j = j < 0 ? 0 : j;
        s = i > nx - 2 ? 1.0f : s, t = j > ny - 2 ? 1.0f : t;
        i = i > nx - 2 ? nx - 2 : i, j = j > ny - 2 ? ny - 2 : j;
        place[k] = j * stride + i;
        along[k] = s, across[k] = t;
        const std::int32_t inside_x = px >= 0 ? (px <= wide ? 1 : 0) : 0;
        inside[k] = py >= 0 ? (py <= high ? inside_x : 0) : 0;
    }
    for (std::size_t k = 0; k < count; ++k) {
        memcpy(below + 2 * k, height + place[k], 2 * sizeof(float));
        memcpy(above + 2 * k, height + place[k] + stride, 2 * sizeof(float));
    }
    for (std::size_t k = 0; k < count; ++k) {
        const float low = below[2 * k] + along[k] * (below[2 * k + 1] - below[2 * k]);
        const float up = above[2 * k] + along[k] * (above[2 * k + 1] - above[2 * k]);
        const float value = level + (low + across[k] * (up - low));
        out[k] = inside[k] ? value : 0.0f;
    }
}

/// The surface over each of sixteen clusters from its four samples (null: the calm surface), whether the cluster is wet,
/// cut or dry, and the moments of the wet ones.
static void measure_clusters(const ClusterBlock* block, const BodyLevel* level, const float* samples,
                             ClusterPlanes* planes, WetLanes* sum) {
    static const float calm[4 * kernel_lanes] = {};
    const float* h = samples ? samples : calm;
    const float* moment = block->moment[0][0];
    const float* axis = block->axis[0][0];
    const float* centroid = block->centroid[0];
    const float* extent = block->extent[0];
    const float* per_span = block->per_span[0];
    const float* area = block->area;
    float* force = sum->force[0];
    float* torque = sum->torque[0];
    float* sum_area = sum->area;
    float* sum_depth = sum->depth;
    float* offset = planes->offset;
    float* slope = planes->slope[0];
    std::int32_t* state = planes->state;
    constexpr std::size_t n = kernel_lanes;
    const float ux = level->up[0], uy = level->up[1], uz = level->up[2], unit = level->per_metre, rest = level->level;
    FRM_EACH_LANE
    for (std::size_t k = 0; k < kernel_lanes; ++k) {
        const float h0 = h[k] * unit, h1 = h[n + k] * unit;
        const float h2 = h[2 * n + k] * unit, h3 = h[3 * n + k] * unit;
        const float s0 = (h0 - h1) * per_span[k], s1 = (h2 - h3) * per_span[n + k];
        const float mean = ((h0 + h1) + (h2 + h3)) * 0.25f;
        const float a0x = axis[k], a0y = axis[n + k], a0z = axis[2 * n + k];
        const float a1x = axis[3 * n + k], a1y = axis[4 * n + k], a1z = axis[5 * n + k];
        const float a2x = axis[6 * n + k], a2y = axis[7 * n + k], a2z = axis[8 * n + k];
        const float cx = centroid[k], cy = centroid[n + k], cz = centroid[2 * n + k];
        const float sx = (s0 * a0x + s1 * a1x) - ux, sy = (s0 * a0y + s1 * a1y) - uy, sz = (s0 * a0z + s1 * a1z) - uz;
        const float at = (rest + mean) - (ux * cx + uy * cy + uz * cz);
        const float d0 = s0 - (ux * a0x + uy * a0y + uz * a0z), d1 = s1 - (ux * a1x + uy * a1y + uz * a1z);
        const float d2 = ux * a2x + uy * a2y + uz * a2z;
        const float reach = ((d0 < 0 ? -d0 : d0) * extent[k] + (d1 < 0 ? -d1 : d1) * extent[n + k]) +
                            (d2 < 0 ? -d2 : d2) * extent[2 * n + k];
        const bool wet = at - reach > 0;
        slope[k] = sx;
        slope[n + k] = sy;
        slope[2 * n + k] = sz;
        offset[k] = at - (sx * cx + sy * cy + sz * cz);
        const bool dry = at + reach <= 0;
        state[k] = wet ? cluster_wet : dry ? cluster_dry : cluster_cut;
        const float keep = wet ? 1.0f : 0.0f, b = wet ? at : 0.0f;
        const float x = wet ? sx : 0.0f, y = wet ? sy : 0.0f, z = wet ? sz : 0.0f;
        force[k] += (b * moment[k] + x * moment[6 * n + k]) + (y * moment[12 * n + k] + z * moment[18 * n + k]);
        force[n + k] += (b * moment[n + k] + x * moment[7 * n + k]) + (y * moment[13 * n + k] + z * moment[19 * n + k]);
        force[2 * n + k] +=
            (b * moment[2 * n + k] + x * moment[8 * n + k]) + (y * moment[14 * n + k] + z * moment[20 * n + k]);
        torque[k] +=
            (b * moment[3 * n + k] + x * moment[9 * n + k]) + (y * moment[15 * n + k] + z * moment[21 * n + k]);
        torque[n + k] +=
            (b * moment[4 * n + k] + x * moment[10 * n + k]) + (y * moment[16 * n + k] + z * moment[22 * n + k]);
        torque[2 * n + k] +=
            (b * moment[5 * n + k] + x * moment[11 * n + k]) + (y * moment[17 * n + k] + z * moment[23 * n + k]);
        sum_area[k] += keep * area[k];
        sum_depth[k] += b * area[k];
    }
}

/// Sixteen triangles under the plane depth(X) = offset + slope . X, added to `sum`; the wet area of each lane to `area`.
/// Returns how many are cut.
///
/// With barycentric coordinates l_i and depths d_i at the corners, integral l_i d dA over the triangle is A (d_i + sum d) /
/// 12. Where the surface cuts it, the corner p that is alone on its side has a tip of s t A, s and t the parts of its two
/// edges up to the surface, over which the integrals are s t A d_p (4 - s - t) / 12 for l_p, s t A d_p s / 12 for the
/// corner at the end of the first edge, t for the other. The wet part is the whole (three corners wet), the tip (one), or
/// the whole less the tip (two): integrals are linear, and depths have signs.
static std::uint32_t clip_triangles(const TriangleBatch* batch, float offset, float ax, float ay, float az,
                                    WetLanes* sum, float* area) {
    std::int32_t cuts[kernel_lanes];
    const float* corner_x = batch->x[0];
    const float* corner_y = batch->y[0];
    const float* corner_z = batch->z[0];
    const float* normal = batch->normal[0];
    const float* whole_area = batch->area;
    float* force = sum->force[0];
    float* torque = sum->torque[0];
    float* sum_depth = sum->depth;
    float* wet_area = area;
    constexpr std::size_t n = kernel_lanes;
    FRM_EACH_LANE
    for (std::size_t k = 0; k < kernel_lanes; ++k) {
        const float x1 = corner_x[k], x2 = corner_x[n + k], x3 = corner_x[2 * n + k];
        const float y1 = corner_y[k], y2 = corner_y[n + k], y3 = corner_y[2 * n + k];
        const float z1 = corner_z[k], z2 = corner_z[n + k], z3 = corner_z[2 * n + k];
        const float d1 = offset + (ax * x1 + ay * y1 + az * z1), d2 = offset + (ax * x2 + ay * y2 + az * z2);
        const float d3 = offset + (ax * x3 + ay * y3 + az * z3);
        const std::int32_t w1 = d1 > 0 ? 1 : 0, w2 = d2 > 0 ? 1 : 0, w3 = d3 > 0 ? 1 : 0, wet = w1 + w2 + w3;
        const std::int32_t cut = ((w1 ^ w2) | (w2 ^ w3));
        const std::int32_t first = (w1 ^ w2) & (w1 ^ w3), second = (w2 ^ w1) & (w2 ^ w3);  // which corner is alone
        const float dp = first ? d1 : second ? d2 : d3, dq = first ? d2 : second ? d3 : d1;
        const float dr = first ? d3 : second ? d1 : d2;
        const float s = dp / (cut ? dp - dq : 1.0f), t = dp / (cut ? dp - dr : 1.0f);
        const float whole = wet >= 2 ? 1.0f : 0.0f;
        const float sign = cut ? (wet == 1 ? 1.0f : -1.0f) : 0.0f;
        // Not sign * s: where nothing is cut, s is a depth, of any size.
        const float tip = cut ? sign * (s * t) : 0.0f, part = tip * dp * (1.0f / 12);
        const float total = whole * ((d1 + d2) + d3);
        const float share = whole + tip;
        const float mp = cut ? part * (4.0f - s - t) : 0.0f, mq = cut ? part * s : 0.0f, mr = cut ? part * t : 0.0f;
        const float m1 = (whole * d1 + total) * (1.0f / 12) + (first ? mp : second ? mr : mq);
        const float m2 = (whole * d2 + total) * (1.0f / 12) + (first ? mq : second ? mp : mr);
        const float m3 = (whole * d3 + total) * (1.0f / 12) + (first ? mr : second ? mq : mp);
        const float depth = (m1 + m2) + m3;
        const float rx = m1 * x1 + m2 * x2 + m3 * x3, ry = m1 * y1 + m2 * y2 + m3 * y3;
        const float rz = m1 * z1 + m2 * z2 + m3 * z3;
        const float nx = normal[k], ny = normal[n + k], nz = normal[2 * n + k];
        force[k] += depth * nx;
        force[n + k] += depth * ny;
        force[2 * n + k] += depth * nz;
        torque[k] += ry * nz - rz * ny;
        torque[n + k] += rz * nx - rx * nz;
        torque[2 * n + k] += rx * ny - ry * nx;
        sum_depth[k] += depth * whole_area[k];
        wet_area[k] += share * whole_area[k];
        cuts[k] = whole_area[k] > 0 ? cut : 0;
    }
    std::int32_t count = 0;
    for (std::size_t k = 0; k < kernel_lanes; ++k) count += cuts[k];
    return static_cast<std::uint32_t>(count);
}

/// The smallest and the largest of a rectangle, and h - h of all added up: not a number as soon as one is not finite.
/// At most kernel_longest_row columns.
static void height_range(const float* h, std::ptrdiff_t stride, std::ptrdiff_t columns, std::ptrdiff_t rows,
                         float* least, float* most, float* odd) {
    float low[kernel_longest_row], high[kernel_longest_row], sum[kernel_longest_row];
    low[0] = high[0] = h[0], sum[0] = h[0] - h[0];
    for (std::ptrdiff_t i = 1; i < columns; ++i) low[i] = high[i] = h[i], sum[i] = h[i] - h[i];
    for (std::ptrdiff_t j = 1; j < rows; ++j) {
        const float* row = h + j * stride;
        for (std::ptrdiff_t i = 0; i < columns; ++i) {
            const float v = row[i];
            low[i] = v < low[i] ? v : low[i];
            high[i] = v > high[i] ? v : high[i];
            sum[i] += v - v;
        }
    }
    for (std::ptrdiff_t i = 1; i < columns; ++i) {
        low[0] = low[i] < low[0] ? low[i] : low[0];
        high[0] = high[i] > high[0] ? high[i] : high[0];
        sum[0] += sum[i];
    }
    *least = low[0], *most = high[0], *odd = sum[0];
}
