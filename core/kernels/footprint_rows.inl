// What a body lays on the water: slices of its volume on grids of several cell sizes, and rows of those.

static float clamp_to(float v, float high) {
    const float up = v > 0 ? v : 0.0f;
    return up < high ? up : high;
}

/// Of a column from the surface down to where the width asked for is w: how much of it, in width, a level of cell c
/// takes. Slices count in full at w = c, less towards c / 2 and 2 c in a straight line; the finest level takes all that is
/// narrower, the widest c^2 / w^2 of what is wider, as K(0) goes down. This is the integral of that from 0 to w.
/// `finest` and `widest` are 0 or 1: numbers, so that every lane does the same.
static float slices_above(float w, float c, float inverse, float finest, float widest) {
    const float rise = clamp_to(w - 0.5f * c, 0.5f * c), fall = clamp_to(w - c, c);
    const float over = w > c ? w : c, under = w < c ? w : c;
    const float begun = finest * under + (1.0f - finest) * (rise * rise * inverse);
    return begun + (widest * (c - c * c / over) + (1.0f - widest) * (fall - 0.5f * inverse * fall * fall));
}

/// What sixteen elements of a body, `depth` (of the body's centre) below the calm surface, lay on a level: the wet part of
/// each's column, in shares of the element's volume times that; and, at the widest level, what it leaves to all of the
/// water. An element stands for a column as high as it is thick: h = sqrt(sum (up_k)^2 spread_k).
static void slice_elements(const ElementBlock* block, const SliceLevel* level, float depth, float ux, float uy,
                           float uz, float* __restrict laid, float* __restrict left) {
    const float c = level->cell, inverse = 1.0f / c, width = level->width;
    const float finest = level->finest, widest = level->widest, spread = level->spread;
    const float* spread_x = block->spread[0];
    const float* spread_y = block->spread[1];
    const float* spread_z = block->spread[2];
    const float* at_x = block->x;
    const float* at_y = block->y;
    const float* at_z = block->z;
    const float* volume = block->volume;
    FRM_EACH_LANE
    for (std::size_t k = 0; k < kernel_lanes; ++k) {
        const float square = ux * ux * spread_x[k] + uy * uy * spread_y[k] + uz * uz * spread_z[k];
        const float half = width * sqrtf(square > 0 ? square : 0.0f), h = half > 0.02f ? half : 0.02f;
        const float middle = width * (depth - (ux * at_x[k] + uy * at_y[k] + uz * at_z[k]));
        const float high = middle - h > 0 ? middle - h : 0.0f, low = middle + h > 0 ? middle + h : 0.0f;
        const float taken =
            slices_above(low, c, inverse, finest, widest) - slices_above(high, c, inverse, finest, widest);
        const float per = volume[k] / (2.0f * h), wet = low - high;
        laid[k] = per * (spread * taken + (1.0f - spread) * wet);
        const float beyond = (low > c ? low - c : 0.0f) - (high > c ? high - c : 0.0f);
        const float narrow = (c - c * c / (low > c ? low : c)) - (c - c * c / (high > c ? high : c));
        left[k] = spread * widest * per * (beyond - narrow);
    }
}

/// Twice as many columns: a quadratic spline in terms of one of half the cell (weights 3/4 and 1/4; Chaikin 1974).
static void refine_columns(float* __restrict fine, const float* __restrict coarse, std::ptrdiff_t eights) {
    for (; eights > 0; --eights, coarse += 8, fine += 16)
        for (std::ptrdiff_t i = 0; i < 8; ++i) {
            const float most = 0.75f * coarse[i];
            fine[2 * i] = most + 0.25f * coarse[i - 1];
            fine[2 * i + 1] = most + 0.25f * coarse[i + 1];
        }
}

/// A grid, in whole eights of columns, added to one of half the cell. Rows before the first and after the last count as
/// empty, and have one row of finer cells each; a column before and after is read.
static void refine(float* fine, std::ptrdiff_t fine_stride, const float* coarse, std::ptrdiff_t stride,
                   std::ptrdiff_t rows, std::ptrdiff_t eights) {
    float buffer[3][2 * kernel_longest_row];
    float *below = buffer[0], *here = buffer[1], *above = buffer[2];
    const std::ptrdiff_t count = 16 * eights;
    for (std::ptrdiff_t i = 0; i < count; ++i) below[i] = here[i] = 0;
    refine_columns(above, coarse, eights);
    for (std::ptrdiff_t j = 0; j <= rows; ++j) {  // between coarse rows j - 1 and j
        float* const free = below;
        below = here, here = above, above = free;
        float* const low = fine + (2 * j - 1) * fine_stride;
        float* const high = low + fine_stride;
        for (std::ptrdiff_t k = 0; k < count; k += 16)
            for (std::ptrdiff_t i = k; i < k + 16; ++i) {
                low[i] += 0.75f * below[i] + 0.25f * here[i];
                high[i] += 0.75f * here[i] + 0.25f * below[i];
            }
        if (j + 1 < rows)
            refine_columns(above, coarse + (j + 1) * stride, eights);
        else
            for (std::ptrdiff_t i = 0; i < count; ++i) above[i] = 0;
    }
}

/// h[i] += now[i] - before[i]
static void add_change_row(float* __restrict h, const float* __restrict now, const float* __restrict before,
                           std::ptrdiff_t count) {
    for (std::ptrdiff_t i = 0; i < count; ++i) h[i] += now[i] - before[i];
}

/// Sixteen lanes by a fixed tree.
static float sum_of_lanes(float* lanes) {
    for (std::ptrdiff_t width = kernel_lanes / 2; width > 0; width /= 2)
        for (std::ptrdiff_t k = 0; k < width; ++k) lanes[k] += lanes[k + width];
    return lanes[0];
}

/// h += half of the change from `before` to `now`, over a rectangle; the sum of those heights times the change.
static float change_work(float* h, std::ptrdiff_t stride, const float* now, const float* before, std::ptrdiff_t columns,
                         std::ptrdiff_t rows, std::ptrdiff_t count) {
    constexpr std::ptrdiff_t lanes = kernel_lanes;
    float sum[lanes] = {};
    for (std::ptrdiff_t j = 0; j < rows; ++j, h += stride, now += columns, before += columns) {
        const auto add = [&](std::ptrdiff_t i, std::ptrdiff_t k) {
            const float change = now[i + k] - before[i + k], mean = h[i + k] + 0.5f * change;
            h[i + k] = mean;
            sum[k] += mean * change;
        };
        std::ptrdiff_t i = 0;
        for (; i + lanes <= count; i += lanes) {
            FRM_EACH_LANE
            for (std::ptrdiff_t k = 0; k < lanes; ++k) add(i, k);
        }
        for (std::ptrdiff_t k = 0; i + k < count; ++k) add(i, k);
    }
    return sum_of_lanes(sum);
}

/// Sum of p times the divergence (u[i + 1] - u[i] + v[i + stride] - v[i]) over a rectangle: in sixteen lanes, then by a
/// tree.
static float pressed_divergence(const float* p, std::ptrdiff_t columns, const float* u, const float* v,
                                std::ptrdiff_t stride, std::ptrdiff_t rows, std::ptrdiff_t count) {
    constexpr std::ptrdiff_t lanes = kernel_lanes;
    float sum[lanes] = {};
    for (std::ptrdiff_t j = 0; j < rows; ++j, p += columns, u += stride, v += stride) {
        const float* const above = v + stride;
        std::ptrdiff_t i = 0;
        for (; i + lanes <= count; i += lanes)
            for (std::ptrdiff_t k = 0; k < lanes; ++k)
                sum[k] += p[i + k] * ((u[i + k + 1] - u[i + k]) + (above[i + k] - v[i + k]));
        for (std::ptrdiff_t k = 0; i + k < count; ++k)
            sum[k] += p[i + k] * ((u[i + k + 1] - u[i + k]) + (above[i + k] - v[i + k]));
    }
    return sum_of_lanes(sum);
}
