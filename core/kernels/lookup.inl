// Eq. 6 for sixteen sources of a body: where in the map each one's stream lies, then what the map has there. What is
// said in words and in double precision in core/map/lookup.h.

#if defined(__clang__)
#define FRM_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define FRM_INDEPENDENT _Pragma("GCC ivdep")
#else
#define FRM_INDEPENDENT
#endif

namespace {

constexpr int block = static_cast<int>(lookup_block);

/// For each source of a block: three directions around the stream, by the octahedron's face and weights.
struct alignas(64) Places {
    std::int32_t face[block];
    float weight[3][block];
};

/// All that the second pass needs.
struct alignas(64) Block {
    Places mean, swing;
    float pressure[block], friction[block];  ///< by which rows are multiplied
    std::int32_t sample[block];
    float share[block];                       ///< of the way from that sample to the next
    float before[3][block], after[3][block];  ///< weights of those samples, of each direction
    std::int32_t speed[block];
    float speed_share[block];
    const ForceRow* mean_row[3][block];
    const SwingRow* swing_row[3][block];
};

/// Barycentric in the face of DirectionSet(n) through which (x, y, z) goes, as DirectionSet::interpolate; any number,
/// zero or NaN too, gives a face that there is.
FRM_INLINE void find_faces(const LookupBlock& b, std::int32_t frequency, Places& out) {
    const float n = static_cast<float>(frequency), last = n - 1.0f;
    const float *bx = b.x, *by = b.y, *bz = b.z;
    FRM_INDEPENDENT
    for (int s = 0; s < block; ++s) {
        const float x = bx[s], y = by[s], z = bz[s];
        const float ax = x < 0.0f ? -x : x, ay = y < 0.0f ? -y : y, az = z < 0.0f ? -z : z;
        const float sum = (ax + ay) + az, size = sum > 0.0f ? sum : 1.0f;
        const float p = ax / size * n, q = ay / size * n;
        const std::int32_t i = static_cast<std::int32_t>(p < last ? p : last);
        const float room = last - static_cast<float>(i);
        const std::int32_t j = static_cast<std::int32_t>(q < room ? q : room);
        const float fp = p - static_cast<float>(i), fq = q - static_cast<float>(j), both = fp + fq;
        const bool inner = (static_cast<float>(j) < room ? both : 0.0f) > 1.0f;
        const float rest = inner ? both - 1.0f : 1.0f - both;
        const std::int32_t octant = (x < 0.0f ? 4 : 0) + (y < 0.0f ? 2 : 0) + (z < 0.0f ? 1 : 0);
        out.face[s] = octant * frequency * frequency + i * (2 * frequency - i) + 2 * j + (inner ? 1 : 0);
        out.weight[0][s] = inner ? 1.0f - fp : fp;
        out.weight[1][s] = inner ? 1.0f - fq : fq;
        out.weight[2][s] = rest > 0.0f ? rest : 0.0f;
    }
}

/// The relative velocity, its size, map time and the samples next to it, and the factors of Eq. 6.
FRM_INLINE void find_streams(const LookupTable& map, const LookupMotion& m, LookupBlock& b, std::size_t first,
                             Block& out) {
    const float *px = map.x + first, *py = map.y + first, *pz = map.z + first;
    const float vx = m.velocity[0], vy = m.velocity[1], vz = m.velocity[2];
    const float wx = m.rotation[0], wy = m.rotation[1], wz = m.rotation[2];
    const float period = map.period, per_period = 1.0f / period;
    const float last = static_cast<float>(map.samples) - 1.0f;
    FRM_INDEPENDENT
    for (int s = 0; s < block; ++s) {
        const float x = b.x[s] - (vx + (wy * pz[s] - wz * py[s]));
        const float y = b.y[s] - (vy + (wz * px[s] - wx * pz[s]));
        const float z = b.z[s] - (vz + (wx * py[s] - wy * px[s]));
        b.x[s] = x, b.y[s] = y, b.z[s] = z;
        const float speed = sqrtf((x * x + y * y) + z * z), ratio = speed * m.per_base_speed, wet = b.wet[s];
        b.speed[s] = speed;
        out.pressure[s] = wet * ratio * ratio * m.pressure;
        out.friction[s] = wet * ratio * m.friction;

        const float later = b.time[s] + ratio * m.time, periods = later * per_period;
        const std::int32_t whole = static_cast<std::int32_t>(periods < 1e9f ? periods : 1e9f);
        const float rest = later - static_cast<float>(whole) * period;
        const float inside = rest >= 0.0f ? (rest < period ? rest : 0.0f) : 0.0f;
        const float wrapped = later < period ? later : inside;
        const float time = wet > 0.0f ? wrapped : b.time[s];
        b.time[s] = time;
        const float position = time * map.samples_per_second;
        const std::int32_t sample = static_cast<std::int32_t>(position < last ? position : last);
        const float share = position - static_cast<float>(sample);
        out.sample[s] = sample;
        out.share[s] = share;
    }
}

/// As speed_position(): each interval of the logarithm adds its part, so that the sum is the interval's number and how
/// far into it.
FRM_INLINE void find_speeds(const LookupTable& map, const LookupMotion& m, const LookupBlock& b, Block& out) {
    alignas(64) float logs[block], sum[block];
    FRM_INDEPENDENT
    for (int s = 0; s < block; ++s) logs[s] = frm::logarithm(b.speed[s] * m.reynolds_speed), sum[s] = 0.0f;
    for (std::uint32_t k = 0; k + 1 < map.speeds; ++k) {
        FRM_INDEPENDENT
        for (int s = 0; s < block; ++s) {
            const float part = (logs[s] - map.log_speed[k]) * map.per_log[k];
            sum[s] += part > 0.0f ? (part < 1.0f ? part : 1.0f) : 0.0f;
        }
    }
    const std::int32_t last = static_cast<std::int32_t>(map.speeds) - 2;
    FRM_INDEPENDENT
    for (int s = 0; s < block; ++s) {
        const float limit = static_cast<float>(last);
        const std::int32_t k = static_cast<std::int32_t>(sum[s] < limit ? sum[s] : limit);
        out.speed[s] = k;
        out.speed_share[s] = sum[s] - static_cast<float>(k);
    }
}

/// The weights of the samples; as strong as fluctuation_level() has it.
FRM_INLINE void weigh_samples(const LookupTable& map, bool keep_level, Block& out) {
    alignas(64) float r[3][block], c[3][block], step[3][block], level[block];
    for (int s = 0; s < block; ++s) {
        const FaceCorners& corner = map.swing_corners[out.swing.face[s]];
        for (int k = 0; k < 3; ++k) step[k][s] = map.step[corner.index[k]];
    }
    FRM_INDEPENDENT
    for (int s = 0; s < block; ++s) level[s] = 1.0f;
    if (keep_level) {
        for (int s = 0; s < block; ++s) {
            const FaceLevel& face = map.level[out.swing.face[s]];
            for (int k = 0; k < 3; ++k) r[k][s] = face.rms[k], c[k][s] = face.product[k];
        }
        FRM_INDEPENDENT
        for (int s = 0; s < block; ++s) {
            const float w0 = out.swing.weight[0][s], w1 = out.swing.weight[1][s], w2 = out.swing.weight[2][s];
            const float p = w0 * r[0][s], q = w1 * r[1][s], t = w2 * r[2][s], wanted = (p + q) + t;
            const float crossed = (w1 * w2 * c[0][s] + w2 * w0 * c[1][s]) + w0 * w1 * c[2][s];
            const float found = ((p * p + q * q) + t * t) + 2.0f * crossed, square = wanted * wanted;
            const float usual = found > 0.25f * square ? wanted / sqrtf(found) : 2.0f;
            level[s] = found < square ? usual : 1.0f;
        }
    }
    for (int k = 0; k < 3; ++k) {
        FRM_INDEPENDENT
        for (int s = 0; s < block; ++s) {
            const float weight = out.swing.weight[k][s] * step[k][s] * level[s];
            out.before[k][s] = weight * (1.0f - out.share[s]);
            out.after[k][s] = weight * out.share[s];
        }
    }
}

/// Where the rows are, and they are on their way before the first is read.
FRM_INLINE void find_rows(const LookupTable& map, const LookupMotion& m, const LookupBlock& io, std::size_t first,
                          Block& b) {
    const std::size_t sources = map.sources, series = std::size_t{map.samples} + 1;
    const std::size_t cells = sources * static_cast<std::size_t>(4 * map.frequency * map.frequency + 2);
    const ForceRow* mean = map.mean + first + (m.by_speed ? 0 : map.base * cells);
    const SwingRow* swing = map.swing + first * series;
    for (int s = 0; s < static_cast<int>(io.count); ++s) {
        const auto source = static_cast<std::size_t>(s);
        if (!(io.wet[s] > 0.0f)) continue;
        const FaceCorners& corner = map.corners[b.mean.face[s]];
        const ForceRow* row = mean + source + (m.by_speed ? static_cast<std::size_t>(b.speed[s]) * cells : 0);
        for (int k = 0; k < 3; ++k) {
            b.mean_row[k][s] = row + corner.index[k] * sources;
            fetch(b.mean_row[k][s]);
        }
        if (!m.swinging) continue;
        const FaceCorners& around = map.swing_corners[b.swing.face[s]];
        const SwingRow* sample = swing + source * series + static_cast<std::size_t>(b.sample[s]);
        for (int k = 0; k < 3; ++k) {
            b.swing_row[k][s] = sample + around.index[k] * sources * series;
            fetch(b.swing_row[k][s]);
            fetch(b.swing_row[k][s] + 1);  // every fourth begins a line of its own
        }
    }
}

/// `offset`: from a mean's row to the one wanted.
template <typename Row>
FRM_INLINE void blend_means(const Block& b, int s, std::ptrdiff_t offset, Row& out) {
    Row rows[3];
    for (int k = 0; k < 3; ++k) read(rows[k], b.mean_row[k][s][offset].v);
    out = (rows[0] * b.mean.weight[0][s] + rows[1] * b.mean.weight[1][s]) + rows[2] * b.mean.weight[2][s];
}

template <typename Row>
FRM_INLINE void read_means(const LookupTable& map, const LookupMotion& m, const Block& b, int s, std::ptrdiff_t offset,
                           Row& out) {
    blend_means(b, s, offset, out);
    if (!m.by_speed) return;
    Row fast;
    blend_means(b, s, offset + static_cast<std::ptrdiff_t>(map.sources) * (4 * map.frequency * map.frequency + 2),
                fast);
    out += (fast - out) * b.speed_share[s];
}

template <typename Row>
FRM_INLINE void add_swing(const Block& b, int s, Row& out) {
    Row sum[3];
    for (int k = 0; k < 3; ++k) {
        Row before, after;
        read(before, b.swing_row[k][s][0].v);
        read(after, b.swing_row[k][s][1].v);
        sum[k] = before * b.before[k][s] + after * b.after[k][s];
    }
    out += (sum[0] + sum[1]) + sum[2];
}

template <typename Row>
FRM_INLINE void add_spin(const LookupTable& map, const LookupMotion& m, float wet, std::ptrdiff_t row, Row& out) {
    Row rows[3], factor;
    const auto pitch = static_cast<std::ptrdiff_t>(map.sources);
    for (int k = 0; k < 3; ++k) read(rows[k], map.spin[static_cast<std::ptrdiff_t>(m.spin_axis[k]) * pitch + row].v);
    fill(factor, m.spin_pressure * wet, m.spin_friction * wet);
    out += ((rows[0] * m.spin_weight[0] + rows[1] * m.spin_weight[1]) + rows[2] * m.spin_weight[2]) * factor;
}

template <typename Row>
FRM_INLINE void add_forces(const LookupTable& map, const LookupMotion& m, const Block& b, LookupBlock& io,
                           std::size_t first, LookupSum& total) {
    Row force, mx, my, mz, torque;
    read(force, total.force.v), read(mx, total.x.v), read(my, total.y.v), read(mz, total.z.v);
    read(torque, total.torque.v);
    for (int s = 0; s < static_cast<int>(io.count); ++s) {
        if (!(io.wet[s] > 0.0f)) continue;
        const std::size_t source = first + static_cast<std::size_t>(s);
        Row row, factor;
        read_means(map, m, b, s, 0, row);
        if (m.swinging && !(m.skip_steady && map.steady[source])) add_swing(b, s, row);
        fill(factor, b.pressure[s], b.friction[s]);
        row = row * factor;
        if (m.spinning) add_spin(map, m, io.wet[s], static_cast<std::ptrdiff_t>(source), row);
        write(io.force[s].v, row);
        force += row;
        mx += row * map.x[source];
        my += row * map.y[source];
        mz += row * map.z[source];
        if (map.torque == 0) continue;
        Row turning;
        read_means(map, m, b, s, map.torque, turning);
        turning = turning * factor;
        if (m.spinning) add_spin(map, m, io.wet[s], static_cast<std::ptrdiff_t>(source) + map.spin_torque, turning);
        torque += turning;
    }
    write(total.force.v, force), write(total.x.v, mx), write(total.y.v, my), write(total.z.v, mz);
    write(total.torque.v, torque);
}

}  // namespace

static void look_up_block(const LookupTable& map, const LookupMotion& m, LookupBlock& io, std::size_t first,
                          LookupSum& total) {
    Block b;
    find_streams(map, m, io, first, b);
    find_faces(io, map.frequency, b.mean);
    if (m.by_speed) find_speeds(map, m, io, b);
    if (m.swinging) {
        if (map.one_set)
            b.swing = b.mean;
        else
            find_faces(io, map.swing_frequency, b.swing);
    }
    find_rows(map, m, io, first, b);
    if (m.swinging) weigh_samples(map, m.keep_level, b);
    if (m.skip_friction)
        add_forces<Four>(map, m, b, io, first, total);
    else
        add_forces<Eight>(map, m, b, io, first, total);
}
