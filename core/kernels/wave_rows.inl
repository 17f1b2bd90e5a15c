// Rows of the wave field: wave_step.h has the order in which they are called.

/// One vector of v[i] -= f (h[i] - below[i]).
static inline Lanes moved_across(Lanes v, Lanes h, Lanes below, float f) { return v - f * (h - below); }

// The velocities of a vector are needed at its right end by the heights of the vector before it: heights lag one vector
// behind, and what both need stays in registers. Each array is read and written once.
template <bool moves_above>
static inline void step_row(const WaveRow& row, float f, float g) {
    const WaveRow r = row;  // a copy that no store can change
    float* const h = r.height;
    float* const u = r.velocity_x;
    const std::ptrdiff_t whole = (r.count + FRM_LANES - 1) / FRM_LANES * FRM_LANES;
    Lanes height = load(h), face = load(u) - f * (height - FRM_FROM_LEFT(load(h - FRM_LANES), height));
    if (r.wall_left) face[0] = r.left;
    const auto heights = [&](std::ptrdiff_t i, Lanes next_face, std::ptrdiff_t valid) {
        Lanes above = load(r.above + i);
        if (moves_above) {
            above = moved_across(above, load(r.height_above + i), height, f);
            store(r.above + i, valid < FRM_LANES ? first_lanes(above, valid) : above);
        }
        const Lanes now = height - g * ((FRM_FROM_RIGHT(face, next_face) - face) + (above - load(r.below + i)));
        store(h + i, valid < FRM_LANES ? first_lanes(now, valid) : now);
    };
    std::ptrdiff_t i = 0;
    for (; i < whole - FRM_LANES; i += FRM_LANES) {
        const Lanes next = load(h + i + FRM_LANES);
        const Lanes next_face = load(u + i + FRM_LANES) - f * (next - FRM_FROM_LEFT(height, next));
        store(u + i, face);
        heights(i, next_face, FRM_LANES);
        height = next, face = next_face;
    }
    const std::ptrdiff_t valid = r.count - i;
    if (valid < FRM_LANES) face = with_lane(first_lanes(face, valid), valid, r.right);
    store(u + i, face);
    heights(i, with_lane(Lanes{}, 0, r.right), valid);
    if (valid == FRM_LANES) u[r.count] = r.right;
}

static void wave_row(const WaveRow& r, float f, float g) {
    if (r.height_above)
        step_row<true>(r, f, g);
    else
        step_row<false>(r, f, g);
}

// The same at fourth order: differences (27 d1 - d3) / 24, whose two weights are in f1, f3 and g1, g3.
template <bool moves_above>
static inline void step_row_4(const WaveRow4& row, float f1, float f3, float g1, float g3) {
    const WaveRow4 r = row;
    float* const h = r.height;
    float* const u = r.velocity_x;
    const std::ptrdiff_t n = r.count, whole = (n + FRM_LANES - 1) / FRM_LANES * FRM_LANES, last = whole - FRM_LANES;
    // The last vector and the one after it, with the cells' mirror images behind a wall.
    alignas(64) float end_h[2 * FRM_LANES] = {}, end_u[2 * FRM_LANES] = {};
    store(end_h, load(h + last));
    if (r.wall_right) {
        end_h[n - last] = h[n - 1];
        end_h[n - last + 1] = h[n - 2];
    }
    const auto height_at = [&](std::ptrdiff_t i) { return i < last ? load(h + i) : load(end_h + (i - last)); };
    const auto faces_of = [&](std::ptrdiff_t i, Lanes left, Lanes x, Lanes right) {
        const Lanes near = x - FRM_FROM_LEFT(left, x);
        const Lanes far = FRM_FROM_RIGHT(x, right) - FRM_FROM_LEFT_2(left, x);
        return load(u + i) - (f1 * near - f3 * far);
    };
    Lanes height = height_at(0), before = load(h - FRM_LANES);
    if (r.wall_left) before = with_lane(with_lane(before, FRM_LANES - 1, h[0]), FRM_LANES - 2, h[1]);
    Lanes next = height_at(FRM_LANES), face = faces_of(0, before, height, next), face_before = load(u - FRM_LANES);
    // Beyond a wall velocities go on as an odd function about the one on it.
    const auto patched = [&](Lanes faces) {
        store(end_u, faces);
        for (std::ptrdiff_t k = n - last; k < 2 * FRM_LANES; ++k) end_u[k] = 0;
        end_u[n - last] = r.right;
        if (r.wall_right) end_u[n - last + 1] = 2 * r.right - (n - last > 0 ? end_u[n - last - 1] : 0.0f);
        return load(end_u);
    };
    if (r.wall_left) {
        face[0] = r.left;
        face_before = with_lane(face_before, FRM_LANES - 1, 2 * r.left - face[1]);
    }
    if (last == 0) face = patched(face);
    const auto heights = [&](std::ptrdiff_t i, Lanes next_face, std::ptrdiff_t valid) {
        Lanes above = load(r.above_2 + i);
        const Lanes v = load(r.velocity_y + i), near_above = load(r.above + i);
        if (moves_above) {
            const Lanes near = load(r.height_2 + i) - load(r.height_1 + i), far = load(r.height_3 + i) - height;
            above = above - (f1 * near - f3 * far);
            store(r.above_2 + i, valid < FRM_LANES ? first_lanes(above, valid) : above);
        }
        const Lanes near = (FRM_FROM_RIGHT(face, next_face) - face) + (near_above - v);
        const Lanes far = (FRM_FROM_RIGHT_2(face, next_face) - FRM_FROM_LEFT(face_before, face)) +
                          (above - load(r.below + i));
        const Lanes now = height - (g1 * near - g3 * far);
        store(h + i, valid < FRM_LANES ? first_lanes(now, valid) : now);
    };
    std::ptrdiff_t i = 0;
    for (; i < last; i += FRM_LANES) {
        const Lanes after = i + FRM_LANES < last ? height_at(i + 2 * FRM_LANES) : load(end_h + FRM_LANES);
        Lanes next_face = faces_of(i + FRM_LANES, height, next, after);
        if (i + FRM_LANES == last) next_face = patched(next_face);
        store(u + i, face);
        heights(i, next_face, FRM_LANES);
        height = next, next = after;
        face_before = face, face = next_face;
    }
    store(u + i, first_lanes(face, n - last + 1));
    heights(i, load(end_u + FRM_LANES), n - i);
    u[n] = r.right;
}

static void wave_row_4(const WaveRow4& r, float f1, float f3, float g1, float g3) {
    if (r.height_3)
        step_row_4<true>(r, f1, f3, g1, g3);
    else
        step_row_4<false>(r, f1, f3, g1, g3);
}

static void wave_faces(float* __restrict v, const float* __restrict h, const float* __restrict below,
                       std::ptrdiff_t count, float f) {
    for (std::ptrdiff_t i = 0; i < count; ++i) v[i] -= f * (h[i] - below[i]);
}

static void wave_faces_4(float* __restrict v, const float* __restrict h, const float* __restrict below,
                         const float* above, const float* below_2, std::ptrdiff_t count, float f1, float f3) {
    for (std::ptrdiff_t i = 0; i < count; ++i)
        v[i] -= f1 * (h[i] - below[i]) - f3 * (above[i] - below_2[i]);
}

static void wave_outflow(float* __restrict v, const float* __restrict h, std::ptrdiff_t count, float factor) {
    for (std::ptrdiff_t i = 0; i < count; ++i) v[i] = factor * h[i];
}

static void wave_push(float* __restrict u, const float* __restrict p, std::ptrdiff_t behind, std::ptrdiff_t count,
                      float factor) {
    for (std::ptrdiff_t i = 0; i < count; ++i) u[i] += factor * (p[i] - p[i - behind]);
}

static void scale(float* __restrict x, std::ptrdiff_t count, float factor) {
    for (std::ptrdiff_t i = 0; i < count; ++i) x[i] *= factor;
}

static inline void scale_ends(float* x, const float* left, const float* right, const WaveDamp& d) {
    for (std::ptrdiff_t i = 0; i < d.left; i += FRM_LANES) store(x + i, load(x + i) * load(left + i));
    for (std::ptrdiff_t i = 0; i < d.right; i += FRM_LANES)
        store(x + d.right_at + i, load(x + d.right_at + i) * load(right + i));
}

static void wave_damp(float* h, float* u, float* v, const WaveDamp& damp) {
    const WaveDamp d = damp;
    if (h) scale_ends(h, d.cells_left, d.cells_right, d);
    if (u) scale_ends(u, d.faces_left, d.faces_right, d);
    if (v) scale_ends(v, d.cells_left, d.cells_right, d);
}
