// Rows of the wave field: core/water/wave_step.h has the order in which they are called.

/// One vector of v[i] -= f (h[i] - below[i]).
static inline Lanes moved_across(Lanes v, Lanes h, Lanes below, float f) { return v - f * (h - below); }

/// How a row ends: its last vector's lanes that are cells, and the lane of the face after them if it is in that vector.
struct RowEnd {
    std::ptrdiff_t last;  ///< where the last vector begins
    LaneNumbers cells, face;
    bool face_after;  ///< the face after the last cell begins the next vector

    explicit RowEnd(std::ptrdiff_t count)
        : last((count - 1) / FRM_LANES * FRM_LANES), face_after(count - last == FRM_LANES) {
        const LaneNumbers lane = FRM_LANE_NUMBERS;
        const auto valid = static_cast<int>(count - last);
        cells = lane < valid, face = lane == valid;
    }
};

// The velocities of a vector are needed at its right end by the heights of the vector before it: heights lag one vector
// behind, and what both need stays in registers. Each array is read and written once.
template <bool moves_above>
static inline void step_row(const WaveRows& r, const RowEnd& end, float* const h, float* const u, float* const v,
                            float f, float g) {
    const float* const height_above = h + r.stride;
    float* const v_above = v + r.stride;
    const float left = -r.outflow * h[0], right = r.wall_right ? r.outflow * h[r.count - 1] : 0.0f;
    Lanes height = load(h), face = load(u) - f * (height - FRM_FROM_LEFT(load(h - FRM_LANES), height));
    if (r.wall_left) face[0] = left;
    const auto heights = [&](std::ptrdiff_t i, Lanes next_face, const auto& kept) {
        Lanes above = load(v_above + i);
        if (moves_above) {
            above = kept(moved_across(above, load(height_above + i), height, f));
            store(v_above + i, above);
        }
        store(h + i, kept(height - g * ((FRM_FROM_RIGHT(face, next_face) - face) + (above - load(v + i)))));
    };
    for (std::ptrdiff_t i = 0; i < end.last; i += FRM_LANES) {
        const Lanes next = load(h + i + FRM_LANES);
        const Lanes next_face = load(u + i + FRM_LANES) - f * (next - FRM_FROM_LEFT(height, next));
        store(u + i, face);
        heights(i, next_face, [](Lanes x) { return x; });
        height = next, face = next_face;
    }
    face = either(only(face, end.cells), only(all_lanes(right), end.face));
    store(u + end.last, face);
    heights(end.last, with_lane(Lanes{}, 0, right), [&](Lanes x) { return only(x, end.cells); });
    if (end.face_after) u[r.count] = right;
}

// The same at fourth order: differences (27 d1 - d3) / 24, whose two weights are in f1, f3 and g1, g3.
template <bool moves_above>
static inline void step_row_4(const WaveRows& r, float* const h, float* const u, float* const v, const float* height_3,
                              float f1, float f3, float g1, float g3) {
    const float *const height_1 = h + r.stride, *const height_2 = height_1 + r.stride;
    const float *const v_below = v - r.stride, *const v_above = v + r.stride;
    float* const v_above_2 = v + 2 * r.stride;
    const float left = -r.outflow * h[0], right = r.wall_right ? r.outflow * h[r.count - 1] : 0.0f;
    const std::ptrdiff_t n = r.count, whole = (n + FRM_LANES - 1) / FRM_LANES * FRM_LANES, last = whole - FRM_LANES;
    // The last vector of cells and the one after it: behind a wall there are the cells' mirror images, and velocities
    // go on as an odd function about the one on the wall.
    const std::ptrdiff_t valid = n - last;
    Lanes end_h = load(h + last), after_end_h = {};
    float beyond = 0;
    if (r.wall_right) {
        const float h1 = h[n - 1], h2 = h[n - 2];
        const float inner = u[n - 1] - (f1 * (h1 - h2) - f3 * (h1 - h[n - 3]));
        beyond = 2 * right - inner;
        end_h = with_lane(with_lane(end_h, valid, h1), valid + 1, h2);
        after_end_h = with_lane(with_lane(after_end_h, valid - FRM_LANES, h1), valid + 1 - FRM_LANES, h2);
    }
    const Lanes after_end_u = with_lane(with_lane(Lanes{}, valid - FRM_LANES, right), valid + 1 - FRM_LANES, beyond);
    const auto height_at = [&](std::ptrdiff_t i) { return i < last ? load(h + i) : i == last ? end_h : after_end_h; };
    const auto faces_of = [&](std::ptrdiff_t i, Lanes before_x, Lanes x, Lanes after_x) {
        const Lanes near = x - FRM_FROM_LEFT(before_x, x);
        const Lanes far = FRM_FROM_RIGHT(x, after_x) - FRM_FROM_LEFT_2(before_x, x);
        return load(u + i) - (f1 * near - f3 * far);
    };
    Lanes height = height_at(0), before = load(h - FRM_LANES);
    if (r.wall_left) before = with_lane(with_lane(before, FRM_LANES - 1, h[0]), FRM_LANES - 2, h[1]);
    Lanes next = height_at(FRM_LANES), face = faces_of(0, before, height, next), face_before = load(u - FRM_LANES);
    const auto patched = [&](Lanes faces) {
        return with_lane(with_lane(first_lanes(faces, valid), valid, right), valid + 1, beyond);
    };
    if (r.wall_left) {
        face[0] = left;
        face_before = with_lane(face_before, FRM_LANES - 1, 2 * left - face[1]);
    }
    if (last == 0) face = patched(face);
    const auto heights = [&](std::ptrdiff_t i, Lanes next_face, std::ptrdiff_t cells) {
        Lanes above = load(v_above_2 + i);
        const Lanes below = load(v + i), near_above = load(v_above + i);
        if (moves_above) {
            const Lanes near = load(height_2 + i) - load(height_1 + i), far = load(height_3 + i) - height;
            above = above - (f1 * near - f3 * far);
            store(v_above_2 + i, cells < FRM_LANES ? first_lanes(above, cells) : above);
        }
        const Lanes near = (FRM_FROM_RIGHT(face, next_face) - face) + (near_above - below);
        const Lanes far =
            (FRM_FROM_RIGHT_2(face, next_face) - FRM_FROM_LEFT(face_before, face)) + (above - load(v_below + i));
        const Lanes now = height - (g1 * near - g3 * far);
        store(h + i, cells < FRM_LANES ? first_lanes(now, cells) : now);
    };
    std::ptrdiff_t i = 0;
    for (; i < last; i += FRM_LANES) {
        const Lanes after = height_at(i + 2 * FRM_LANES);
        Lanes next_face = faces_of(i + FRM_LANES, height, next, after);
        if (i + FRM_LANES == last) next_face = patched(next_face);
        store(u + i, face);
        heights(i, next_face, FRM_LANES);
        height = next, next = after;
        face_before = face, face = next_face;
    }
    store(u + i, first_lanes(face, valid + 1));
    heights(i, after_end_u, valid);
    if (valid == FRM_LANES) u[n] = right;
}

static void wave_faces(float* __restrict v, const float* __restrict h, const float* __restrict below,
                       std::ptrdiff_t count, float f) {
    for (std::ptrdiff_t i = 0; i < count; ++i) v[i] -= f * (h[i] - below[i]);
}

static void wave_faces_4(float* __restrict v, const float* __restrict h, const float* __restrict below,
                         const float* above, const float* below_2, std::ptrdiff_t count, float f1, float f3) {
    for (std::ptrdiff_t i = 0; i < count; ++i) v[i] -= f1 * (h[i] - below[i]) - f3 * (above[i] - below_2[i]);
}

static void wave_outflow(float* __restrict v, const float* __restrict h, std::ptrdiff_t count, float factor) {
    for (std::ptrdiff_t i = 0; i < count; ++i) v[i] = factor * h[i];
}

static void wave_push(float* __restrict u, const float* __restrict p, std::ptrdiff_t behind, std::ptrdiff_t count,
                      float factor) {
    for (std::ptrdiff_t i = 0; i < count; ++i) u[i] += factor * (p[i] - p[i - behind]);
}

static void wave_push_rows(float* __restrict u, float* __restrict v, std::ptrdiff_t stride, const float* __restrict p,
                           std::ptrdiff_t columns, std::ptrdiff_t rows, std::ptrdiff_t count, float factor) {
    for (std::ptrdiff_t j = 0; j < rows; ++j, u += stride, v += stride, p += columns)
        for (std::ptrdiff_t i = 0; i < count; ++i) {
            u[i] += factor * (p[i] - p[i - 1]);
            v[i] += factor * (p[i] - p[i - columns]);
        }
}

static void scale(float* __restrict x, std::ptrdiff_t count, float factor) {
    for (std::ptrdiff_t i = 0; i < count; ++i) x[i] *= factor;
}

static void scale_ends(float* x, const float* left, const float* right, const WaveDamp& d) {
    for (std::ptrdiff_t i = 0; i < d.left; i += FRM_LANES) store(x + i, load(x + i) * load(left + i));
    for (std::ptrdiff_t i = 0; i < d.right; i += FRM_LANES)
        store(x + d.right_at + i, load(x + d.right_at + i) * load(right + i));
}

/// The part of one row's ends that lies in these rows' columns.
static inline void damp_end(float* x, const float* left, const float* right, const WaveRows& r, const WaveDamp& d) {
    x -= r.first_column;
    if (r.damp_left)
        for (std::ptrdiff_t i = 0; i < d.left; i += FRM_LANES) store(x + i, load(x + i) * load(left + i));
    if (r.damp_right)
        for (std::ptrdiff_t i = 0; i < d.right; i += FRM_LANES)
            store(x + d.right_at + i, load(x + d.right_at + i) * load(right + i));
}

static inline void damp_ends(float* h, float* u, float* v, const WaveRows& r, const WaveDamp& d) {
    damp_end(h, d.cells_left, d.cells_right, r, d);
    damp_end(u, d.faces_left, d.faces_right, r, d);
    damp_end(v, d.cells_left, d.cells_right, r, d);
}

static void wave_rows(const WaveRows& rows, float f, float g) {
    const WaveRows r = rows;  // copies that no store can change
    const WaveDamp d = r.damp ? *r.damp : WaveDamp{};
    const RowEnd end(r.count);
    float *h = r.height, *u = r.velocity_x, *v = r.velocity_y;
    for (std::ptrdiff_t j = 0; j < r.rows; ++j, h += r.stride, u += r.stride, v += r.stride) {
        if (r.with_faces)
            step_row<true>(r, end, h, u, v, f, g);
        else
            step_row<false>(r, end, h, u, v, f, g);
        if (r.damp) damp_ends(h, u, v, r, d);
    }
}

static void wave_rows_4(const WaveRows& rows, float f1, float f3, float g1, float g3) {
    const WaveRows r = rows;
    const WaveDamp d = r.damp ? *r.damp : WaveDamp{};
    float *h = r.height, *u = r.velocity_x, *v = r.velocity_y;
    for (std::ptrdiff_t j = 0; j < r.rows; ++j, h += r.stride, u += r.stride, v += r.stride) {
        if (r.with_faces)
            step_row_4<true>(r, h, u, v, r.height_3 ? r.height_3 : h + 3 * r.stride, f1, f3, g1, g3);
        else
            step_row_4<false>(r, h, u, v, h, f1, f3, g1, g3);
        if (r.damp) damp_ends(h, u, v - r.stride, r, d);
    }
}

static void heights_ahead_row(float* __restrict out, const float* h, const float* h_below, const float* h_above,
                              const float* u, const float* v, const float* v_above, std::ptrdiff_t count, float rise,
                              float bend) {
    for (std::ptrdiff_t i = 0; i < count; ++i) {
        const float around = (h[i - 1] + h[i + 1]) + (h_below[i] + h_above[i]);
        out[i] = h[i] - rise * ((u[i + 1] - u[i]) + (v_above[i] - v[i])) + bend * (around - 4 * h[i]);
    }
}

/// As whole numbers the bits of |x| are in the order of |x|, and those of what is not a number come after all. What is
/// loud mostly is so in its first rows: these are looked at alone. A row's last vector may reach beyond its `count`.
static bool any_above(const float* x, std::ptrdiff_t stride, std::ptrdiff_t rows, std::ptrdiff_t count, float limit) {
    constexpr std::int32_t size_bits = 0x7fffffff;
    constexpr std::size_t words = sizeof(LaneNumbers) / sizeof(std::uint64_t);
    std::int32_t limit_bits;
    memcpy(&limit_bits, &limit, sizeof limit_bits);
    const LaneNumbers lane = FRM_LANE_NUMBERS;
    const std::ptrdiff_t whole = count / FRM_LANES * FRM_LANES;
    const LaneNumbers rest = (lane < static_cast<int>(count - whole)) & size_bits;
    for (std::ptrdiff_t j = 0, end = 4; j < rows; end = rows) {
        LaneNumbers most = {};
        for (; j < rows && j < end; ++j) {
            const float* const row = x + j * stride;
            for (std::ptrdiff_t i = 0; i < whole; i += FRM_LANES) {
                const LaneNumbers size = load_numbers(row + i) & size_bits;
                most = size > most ? size : most;
            }
            if (whole == count) continue;
            const LaneNumbers size = load_numbers(row + whole) & rest;
            most = size > most ? size : most;
        }
        const LaneNumbers above = most > limit_bits;
        std::uint64_t any[words], one = 0;
        memcpy(any, &above, sizeof any);
        for (std::size_t k = 0; k < words; ++k) one |= any[k];
        if (one) return true;
    }
    return false;
}
