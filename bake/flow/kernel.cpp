// Recursive regularised collision (Malaspinas 2015, arXiv:1505.06900; D3Q19 third order as in Jacob, Malaspinas &
// Sagaut 2018, J. Turbulence 19) with a Smagorinsky model in the relaxation time (Hou et al. 1996). The non-equilibrium
// part is rebuilt from its second-order moment only, so nothing else can grow when the relaxation time is next to 1/2.
// The trace of that moment is dropped: it carries sound only, and dropping it damps sound without touching the shear
// viscosity.
#include "bake/flow/kernel.h"

#include <cmath>

// One row is one loop over contiguous floats: the compiler vectorises it for each instruction set below and the machine
// picks at start-up. All of them give the same bits, because -ffp-contract=off keeps the fused instructions out. This
// file needs -fno-math-errno: without it gcc calls the library for std::sqrt and does not vectorise (8 times slower).
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__)
#define FRM_FLOW_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define FRM_FLOW_CLONES
#endif

namespace frm::bake::flow {
namespace {

struct Row {
    const float* from[direction_count];
    float* to[direction_count];
};

FRM_FLOW_CLONES
void collide(const Row& row, std::size_t count, const float* __restrict relaxation, float smagorinsky,
             const float* push) {
    const float* const* const from = row.from;
    float* const* const to = row.to;
    constexpr float third = 1.0f / 3, w0 = 1.0f / 3, w1 = 1.0f / 18, w2 = 1.0f / 36;
    const float model = 18 * smagorinsky;
    const float push_x = push[0], push_y = push[1], push_z = push[2];

#if defined(__clang__)
#pragma clang loop vectorize(assume_safety)
#elif defined(__GNUC__)
#pragma GCC ivdep
#endif
    for (std::size_t x = 0; x < count; ++x) {
        const float f0 = from[0][x], f1 = from[1][x], f2 = from[2][x], f3 = from[3][x], f4 = from[4][x];
        const float f5 = from[5][x], f6 = from[6][x], f7 = from[7][x], f8 = from[8][x], f9 = from[9][x];
        const float f10 = from[10][x], f11 = from[11][x], f12 = from[12][x], f13 = from[13][x], f14 = from[14][x];
        const float f15 = from[15][x], f16 = from[16][x], f17 = from[17][x], f18 = from[18][x];

        const float s_xx = f1 + f2, s_yy = f3 + f4, s_zz = f5 + f6;
        const float s7 = f7 + f8, s9 = f9 + f10, s11 = f11 + f12, s13 = f13 + f14, s15 = f15 + f16, s17 = f17 + f18;
        const float d7 = f7 - f8, d9 = f9 - f10, d11 = f11 - f12, d13 = f13 - f14, d15 = f15 - f16, d17 = f17 - f18;
        const float s_xy = s7 + s9, s_xz = s11 + s13, s_yz = s15 + s17;
        const float excess = f0 + ((s_xx + s_yy) + s_zz) + ((s_xy + s_xz) + s_yz);
        const float rho = 1 + excess;
        const float mx = (f1 - f2) + (d7 + d9) + (d11 + d13);
        const float my = (f3 - f4) + (d7 - d9) + (d15 + d17);
        const float mz = (f5 - f6) + (d11 - d13) + (d15 - d17);
        const float inverse = 1 / rho;
        float ux = mx * inverse, uy = my * inverse, uz = mz * inverse;

        // Second moment less its equilibrium, without the trace.
        float n_xx = s_xx + s_xy + s_xz - mx * ux;
        float n_yy = s_yy + s_xy + s_yz - my * uy;
        float n_zz = s_zz + s_xz + s_yz - mz * uz;
        const float mean = (n_xx + n_yy + n_zz) * third;
        n_xx -= mean;
        n_yy -= mean;
        n_zz -= mean;
        const float n_xy = (s7 - s9) - mx * uy;
        const float n_xz = (s11 - s13) - mx * uz;
        const float n_yz = (s15 - s17) - my * uz;

        // nu_t = C^2 |S| with S from the stress of this very cell: a quadratic equation for the relaxation time. The
        // model's viscosity takes the place of the molecular one where it is the greater, instead of adding to it: a
        // boundary layer that the lattice resolves stays laminar (added, it made a sphere's drag at Re 100 4 % higher).
        const float square = (n_xx * n_xx + n_yy * n_yy + n_zz * n_zz) + 2 * (n_xy * n_xy + n_xz * n_xz + n_yz * n_yz);
        const float modelled = 0.5f + std::sqrt(0.25f + model * std::sqrt(2 * square) * inverse);
        const float molecular = 2 * relaxation[x];
        const float doubled = modelled > molecular ? modelled : molecular;
        const float keep = 1 - 2 / doubled;

        ux += push_x;
        uy += push_y;
        uz += push_z;
        const float jx = rho * ux, jy = rho * uy, jz = rho * uz;
        const float q_xy = keep * n_xy, q_xz = keep * n_xz, q_yz = keep * n_yz;
        const float a_xx = jx * ux + keep * n_xx, a_yy = jy * uy + keep * n_yy, a_zz = jz * uz + keep * n_zz;
        const float a_xy = 9 * (jx * uy + q_xy), a_xz = 9 * (jx * uz + q_xz), a_yz = 9 * (jy * uz + q_yz);

        // Third-order Hermite moments by the recursion u_a A_bc + ..., in the sums and differences D3Q19 can carry.
        const float h_xyy = ux * a_yy + 2 * (uy * q_xy), h_xzz = ux * a_zz + 2 * (uz * q_xz);
        const float h_xxy = uy * a_xx + 2 * (ux * q_xy), h_yzz = uy * a_zz + 2 * (uz * q_yz);
        const float h_xxz = uz * a_xx + 2 * (ux * q_xz), h_yyz = uz * a_yy + 2 * (uy * q_yz);
        const float bx = 4.5f * (h_xyy + h_xzz), by = 4.5f * (h_xxy + h_yzz), bz = 4.5f * (h_xxz + h_yyz);
        const float ex = 4.5f * (h_xyy - h_xzz), ey = 4.5f * (h_xxy - h_yzz), ez = 4.5f * (h_xxz - h_yyz);

        const float base = excess - 1.5f * (a_xx + a_yy + a_zz);
        const float e_xx = 4.5f * a_xx, e_yy = 4.5f * a_yy, e_zz = 4.5f * a_zz;
        const float ox = 3 * jx, oy = 3 * jy, oz = 3 * jz;
        const float axis_x = ox - 2 * bx, axis_y = oy - 2 * by, axis_z = oz - 2 * bz;
        const float xy_x = ox + bx + ex, xy_y = oy + by + ey;
        const float xz_x = ox + bx - ex, xz_z = oz + bz + ez;
        const float yz_y = oy + by - ey, yz_z = oz + bz - ez;
        const float b_x = base + e_xx, b_y = base + e_yy, b_z = base + e_zz;
        const float b_xy = b_x + e_yy, b_xz = b_x + e_zz, b_yz = b_y + e_zz;

        to[0][x] = w0 * base;
        to[1][x] = w1 * (b_x + axis_x);
        to[2][x] = w1 * (b_x - axis_x);
        to[3][x] = w1 * (b_y + axis_y);
        to[4][x] = w1 * (b_y - axis_y);
        to[5][x] = w1 * (b_z + axis_z);
        to[6][x] = w1 * (b_z - axis_z);
        to[7][x] = w2 * ((b_xy + a_xy) + (xy_x + xy_y));
        to[8][x] = w2 * ((b_xy + a_xy) - (xy_x + xy_y));
        to[9][x] = w2 * ((b_xy - a_xy) + (xy_x - xy_y));
        to[10][x] = w2 * ((b_xy - a_xy) - (xy_x - xy_y));
        to[11][x] = w2 * ((b_xz + a_xz) + (xz_x + xz_z));
        to[12][x] = w2 * ((b_xz + a_xz) - (xz_x + xz_z));
        to[13][x] = w2 * ((b_xz - a_xz) + (xz_x - xz_z));
        to[14][x] = w2 * ((b_xz - a_xz) - (xz_x - xz_z));
        to[15][x] = w2 * ((b_yz + a_yz) + (yz_y + yz_z));
        to[16][x] = w2 * ((b_yz + a_yz) - (yz_y + yz_z));
        to[17][x] = w2 * ((b_yz - a_yz) + (yz_y - yz_z));
        to[18][x] = w2 * ((b_yz - a_yz) - (yz_y - yz_z));
    }
}

}  // namespace

void collide_row(const Grid& grid, const Populations& from, Populations& to, std::size_t r,
                 const Collision& collision) {
    const std::size_t first = grid.row(r);
    Row row;
    for (int i = 0; i < direction_count; ++i) {
        row.from[i] = from.at(i) + static_cast<std::ptrdiff_t>(first) - grid.offset(i);
        row.to[i] = to.at(i) + first;
    }
    collide(row, grid.pitch(), collision.relaxation, collision.smagorinsky, collision.push);
}

}  // namespace frm::bake::flow
