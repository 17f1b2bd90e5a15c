#include "core/body/coefficients.h"

#include <algorithm>
#include <cmath>

#include "core/kernels/kernels.h"

namespace frm {
namespace {

using Matrix3 = std::array<Vec3d, 3>;  ///< columns

/// Of the fastest stream (and of the base speed, for a body at rest): by so much a stream is changed to either side to see
/// how its force goes with it. Wide enough for the digits of float, and to see over the edge of a face of directions.
constexpr float probe_share = 0.05f, least_probe = 1e-3f;
constexpr int sweeps = 8;  ///< of Jacobi's rotations; three by three is diagonal to all digits after five

/// Jacobi's rotations: turns the columns of `a` until they are square to each other (one-sided, Hestenes 1958). Then a =
/// U S V^T with the columns u_k s_k.
void make_orthogonal(Matrix3& a) {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
        for (int pair = 0; pair < 3; ++pair) {
            Vec3d &p = a[static_cast<std::size_t>(pair)], &q = a[static_cast<std::size_t>((pair + 1) % 3)];
            const double pp = dot(p, p), qq = dot(q, q), pq = dot(p, q);
            if (!(pq * pq > 1e-28 * pp * qq)) continue;
            const double zeta = (qq - pp) / (2 * pq);
            const double t = (zeta < 0 ? -1 : 1) / (std::fabs(zeta) + std::sqrt(1 + zeta * zeta));
            const double c = 1 / std::sqrt(1 + t * t), s = c * t;
            const Vec3d old = p;
            p = old * c - q * s;
            q = old * s + q * c;
        }
    }
}

/// Adds the damping of a force at `arm` from the origin whose change by the stream is `change` (columns), as its
/// symmetric polar factor (J J^T)^(1/2) = U S U^T: as strong as J in the direction of every change of force, and never
/// driving. (J itself is neither symmetric nor always a brake: a plate at a small angle is turned further.)
void add_source(Matrix3 change, const Vec3d& arm, std::array<double, 36>& out) {
    make_orthogonal(change);
    for (const Vec3d& column : change) {
        const double strength = length(column);
        if (!(strength > 0)) continue;
        const Vec3d u = column / strength, turn = cross(arm, u);
        const double along[6] = {u.x, u.y, u.z, turn.x, turn.y, turn.z};
        for (std::size_t i = 0; i < 6; ++i)
            for (std::size_t j = 0; j < 6; ++j) out[6 * i + j] += strength * along[i] * along[j];
    }
}

/// Inputs for the sources of a block: their streams, if they had been looked up one by one, and how wet they are.
LookupBlock inputs(const Body& body, std::size_t first) {
    LookupBlock block = body.streams.block[first / lookup_block];
    const std::size_t count = std::min(lookup_block, body.sources.size() - first);
    block.count = static_cast<std::uint32_t>(count);
    for (std::size_t s = 0; s < lookup_block; ++s) {
        block.wet[s] = s < count ? body.sources[first + s].wet_ratio : 0.0f;
        block.time[s] = s < count ? body.sources[first + s].map_time : 0.0f;
    }
    return block;
}

/// What turns the body is homogeneous in the rate: its torque goes with the square (friction less), and along itself it
/// changes by at most twice its share of the rate.
void add_spin(const Body& body, const LookupTable& table, LookupMotion motion, std::array<double, 36>& out) {
    const double scale = static_cast<double>(body.def.scale);
    const Vec3d rate(static_cast<double>(motion.rotation[0]), static_cast<double>(motion.rotation[1]),
                     static_cast<double>(motion.rotation[2]));
    const double fast = length(rate) / scale;
    if (!(fast > 0)) return;
    for (int k = 0; k < 3; ++k) motion.velocity[k] = motion.rotation[k] = 0;
    LookupSum sum{};
    for (std::size_t first = 0; first < body.sources.size(); first += lookup_block) {
        LookupBlock block = inputs(body, first);
        for (std::size_t s = 0; s < lookup_block; ++s) block.x[s] = block.y[s] = block.z[s] = 0;
        kernels().look_up_block(table, motion, block, first, sum);
    }
    Vec3d torque;
    for (int half = 0; half < 8; half += 4) {
        const float *x = sum.x.v + half, *y = sum.y.v + half, *z = sum.z.v + half;
        torque += Vec3d(Vec3f(y[2] - z[1], z[0] - x[2], x[1] - y[0])) * scale;
    }
    const double strength = length(torque);
    if (!(strength > 0)) return;
    const Vec3d t = torque / strength;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            out[static_cast<std::size_t>(6 * (3 + i) + 3 + j)] += 2 * strength / fast * t[i] * t[j];
}

/// Body axes to the world's.
std::array<double, 36> turned(const std::array<double, 36>& m, const Rotation<float>& r) {
    const Vec3d row[3] = {Vec3d(r.row0), Vec3d(r.row1), Vec3d(r.row2)};
    std::array<double, 36> half{}, out{};
    const auto part = [&](std::size_t i, int k) { return row[i % 3][k]; };
    const auto at = [](std::size_t i, int k) { return i - i % 3 + static_cast<std::size_t>(k); };
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j < 6; ++j)
            for (int k = 0; k < 3; ++k) half[6 * i + j] += part(i, k) * m[6 * at(i, k) + j];
    for (std::size_t i = 0; i < 6; ++i)
        for (std::size_t j = 0; j <= i; ++j) {
            for (int k = 0; k < 3; ++k) out[6 * i + j] += half[6 * i + at(j, k)] * part(j, k);
            out[6 * j + i] = out[6 * i + j];
        }
    return out;
}

std::array<double, 36> damping(const Body& body) {
    std::array<double, 36> out{};
    const Map& map = *body.def.map;
    const LookupTable table = lookup_table(map);
    LookupMotion still = body.streams.motion;  // what moves the sources is in their streams
    for (int k = 0; k < 3; ++k) still.velocity[k] = still.rotation[k] = 0;
    still.spinning = still.skip_friction = false;
    still.time = 0;
    const double scale = static_cast<double>(body.def.scale);
    for (std::size_t first = 0; first < body.sources.size(); first += lookup_block) {
        LookupBlock at = inputs(body, first);
        if (body.streams.grouped) {  // in still water: the streams are those of its own motion
            LookupMotion moving = still;
            for (int k = 0; k < 3; ++k) {
                moving.velocity[k] = body.streams.motion.velocity[k];
                moving.rotation[k] = body.streams.motion.rotation[k];
            }
            for (std::size_t s = 0; s < lookup_block; ++s) at.x[s] = at.y[s] = at.z[s] = 0;
            LookupSum unused{};
            kernels().look_up_block(table, moving, at, first, unused);
        }
        float fastest = 0;
        for (std::size_t s = 0; s < at.count; ++s)
            if (at.wet[s] > 0) fastest = std::max(fastest, at.x[s] * at.x[s] + at.y[s] * at.y[s] + at.z[s] * at.z[s]);
        const float probe = std::max(probe_share * std::sqrt(fastest), least_probe * map.facts.base_speed);
        const double per_change = 1 / (2 * static_cast<double>(probe));
        Matrix3 change[lookup_block] = {};
        for (int axis = 0; axis < 3; ++axis) {
            for (const float side : {-probe, probe}) {
                LookupBlock block = at;
                float* const stream = axis == 0 ? block.x : axis == 1 ? block.y : block.z;
                for (std::size_t s = 0; s < lookup_block; ++s) stream[s] += side;
                LookupSum unused{};
                kernels().look_up_block(table, still, block, first, unused);
                for (std::size_t s = 0; s < at.count; ++s) {
                    if (!(at.wet[s] > 0)) continue;
                    const float* f = block.force[s].v;
                    const Vec3d force = Vec3d(Vec3f(f[0], f[1], f[2])) + Vec3d(Vec3f(f[4], f[5], f[6]));
                    change[s][static_cast<std::size_t>(axis)] += force * (side > 0 ? per_change : -per_change);
                }
            }
        }
        for (std::size_t s = 0; s < at.count; ++s)
            if (at.wet[s] > 0) add_source(change[s], Vec3d(map.sources[first + s].position) * scale, out);
    }
    if (body.streams.motion.spinning) add_spin(body, table, body.streams.motion, out);
    return out;
}

}  // namespace

Coefficients coefficients_of(const Body& body, const Fluid& fluid) {
    Coefficients out;
    const Map& map = *body.def.map;
    float wet = 0, area = 0;
    for (std::size_t l = 0; l < body.sources.size(); ++l) {
        wet += body.sources[l].wet_ratio * map.region_area[l];
        area += map.region_area[l];
    }
    if (!(wet > 0)) return out;
    out.wet_share = wet / area;
    const Rotation<float>& r = body.streams.rotation;
    if (map.has_added_mass) {
        const double s = static_cast<double>(body.def.scale), unit = static_cast<double>(out.wet_share) *
                                                                     static_cast<double>(fluid.density) /
                                                                     static_cast<double>(map.facts.density) * s * s * s;
        std::array<double, 36> scaled = map.added_mass;
        for (std::size_t i = 0; i < 36; ++i) scaled[i] *= unit * (i / 6 >= 3 ? s : 1) * (i % 6 >= 3 ? s : 1);
        out.added_mass = turned(scaled, r);
    }
    out.damping = turned(damping(body), r);
    return out;
}

}  // namespace frm
