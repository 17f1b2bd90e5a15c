// What a cell's populations say and what becomes of them: the moments before the collision, and the populations after
// it. The bulk's loop and the exchange between blocks share it.
//
// Recursive regularised collision (Malaspinas 2015, arXiv:1505.06900; D3Q19 third order as in Jacob, Malaspinas &
// Sagaut 2018, J. Turbulence 19) with a Smagorinsky model in the relaxation time (Hou et al. 1996). The non-equilibrium
// part is rebuilt from its second-order moment only, so nothing else can grow when the relaxation time is next to 1/2.
// The trace of that moment is dropped: it carries sound only, and dropping it damps sound without touching the shear
// viscosity.
#pragma once

#include <cmath>

#if defined(__GNUC__)
#define FRM_FLOW_INLINE inline __attribute__((always_inline))
#else
#define FRM_FLOW_INLINE inline
#endif

namespace frm::bake::flow {

/// A symmetric tensor.
struct Stress {
    float xx, yy, zz, xy, xz, yz;

    FRM_FLOW_INLINE float square() const { return (xx * xx + yy * yy + zz * zz) + 2 * (xy * xy + xz * xz + yz * yz); }
    FRM_FLOW_INLINE Stress times(float s) const { return {s * xx, s * yy, s * zz, s * xy, s * xz, s * yz}; }
};

/// Density less one, velocity, and the second moment less its equilibrium, without trace.
struct Moments {
    float excess, ux, uy, uz;
    Stress stress;
};

/// `load(i)` gives the population of direction i that arrives at the cell.
template <typename Load>
FRM_FLOW_INLINE Moments moments_of(const Load& load) {
    const float f0 = load(0), f1 = load(1), f2 = load(2), f3 = load(3), f4 = load(4), f5 = load(5), f6 = load(6);
    const float f7 = load(7), f8 = load(8), f9 = load(9), f10 = load(10), f11 = load(11), f12 = load(12);
    const float f13 = load(13), f14 = load(14), f15 = load(15), f16 = load(16), f17 = load(17), f18 = load(18);

    const float s_xx = f1 + f2, s_yy = f3 + f4, s_zz = f5 + f6;
    const float s7 = f7 + f8, s9 = f9 + f10, s11 = f11 + f12, s13 = f13 + f14, s15 = f15 + f16, s17 = f17 + f18;
    const float d7 = f7 - f8, d9 = f9 - f10, d11 = f11 - f12, d13 = f13 - f14, d15 = f15 - f16, d17 = f17 - f18;
    const float s_xy = s7 + s9, s_xz = s11 + s13, s_yz = s15 + s17;
    const float excess = f0 + ((s_xx + s_yy) + s_zz) + ((s_xy + s_xz) + s_yz);
    const float mx = (f1 - f2) + (d7 + d9) + (d11 + d13);
    const float my = (f3 - f4) + (d7 - d9) + (d15 + d17);
    const float mz = (f5 - f6) + (d11 - d13) + (d15 - d17);
    const float inverse = 1 / (1 + excess);
    const float ux = mx * inverse, uy = my * inverse, uz = mz * inverse;

    float n_xx = s_xx + s_xy + s_xz - mx * ux;
    float n_yy = s_yy + s_xy + s_yz - my * uy;
    float n_zz = s_zz + s_xz + s_yz - mz * uz;
    const float mean = (n_xx + n_yy + n_zz) * (1.0f / 3);
    n_xx -= mean;
    n_yy -= mean;
    n_zz -= mean;
    return {excess, ux, uy, uz, {n_xx, n_yy, n_zz, (s7 - s9) - mx * uy, (s11 - s13) - mx * uz, (s15 - s17) - my * uz}};
}

/// Twice the relaxation time: the fluid's, or the sub-grid model's where that is the greater. nu_t = C^2 |S| with S
/// from the stress of this very cell is a quadratic equation. The model's viscosity takes the place of the molecular
/// one instead of adding to it: a boundary layer that the lattice resolves stays laminar (added, it made a sphere's
/// drag at Re 100 4 % higher). `model` is 18 C^2.
FRM_FLOW_INLINE float doubled_relaxation(float excess, float stress_square, float molecular, float model) {
    const float modelled = 0.5f + std::sqrt(0.25f + model * std::sqrt(2 * stress_square) / (1 + excess));
    const float doubled = 2 * molecular;
    return modelled > doubled ? modelled : doubled;
}

/// The populations after collision of a cell of velocity u: those of equilibrium and of `q`, what the collision leaves
/// of the stress. Third-order Hermite moments follow by the recursion u_a A_bc + ..., in the sums and differences that
/// D3Q19 can carry. `store(i, f)` takes the results.
template <typename Store>
FRM_FLOW_INLINE void collided(float excess, float ux, float uy, float uz, const Stress& q, const Store& store) {
    constexpr float w0 = 1.0f / 3, w1 = 1.0f / 18, w2 = 1.0f / 36;
    const float rho = 1 + excess;
    const float jx = rho * ux, jy = rho * uy, jz = rho * uz;
    const float a_xx = jx * ux + q.xx, a_yy = jy * uy + q.yy, a_zz = jz * uz + q.zz;
    const float a_xy = 9 * (jx * uy + q.xy), a_xz = 9 * (jx * uz + q.xz), a_yz = 9 * (jy * uz + q.yz);

    const float h_xyy = ux * a_yy + 2 * (uy * q.xy), h_xzz = ux * a_zz + 2 * (uz * q.xz);
    const float h_xxy = uy * a_xx + 2 * (ux * q.xy), h_yzz = uy * a_zz + 2 * (uz * q.yz);
    const float h_xxz = uz * a_xx + 2 * (ux * q.xz), h_yyz = uz * a_yy + 2 * (uy * q.yz);
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

    store(0, w0 * base);
    store(1, w1 * (b_x + axis_x));
    store(2, w1 * (b_x - axis_x));
    store(3, w1 * (b_y + axis_y));
    store(4, w1 * (b_y - axis_y));
    store(5, w1 * (b_z + axis_z));
    store(6, w1 * (b_z - axis_z));
    store(7, w2 * ((b_xy + a_xy) + (xy_x + xy_y)));
    store(8, w2 * ((b_xy + a_xy) - (xy_x + xy_y)));
    store(9, w2 * ((b_xy - a_xy) + (xy_x - xy_y)));
    store(10, w2 * ((b_xy - a_xy) - (xy_x - xy_y)));
    store(11, w2 * ((b_xz + a_xz) + (xz_x + xz_z)));
    store(12, w2 * ((b_xz + a_xz) - (xz_x + xz_z)));
    store(13, w2 * ((b_xz - a_xz) + (xz_x - xz_z)));
    store(14, w2 * ((b_xz - a_xz) - (xz_x - xz_z)));
    store(15, w2 * ((b_yz + a_yz) + (yz_y + yz_z)));
    store(16, w2 * ((b_yz + a_yz) - (yz_y + yz_z)));
    store(17, w2 * ((b_yz - a_yz) + (yz_y - yz_z)));
    store(18, w2 * ((b_yz - a_yz) - (yz_y - yz_z)));
}

}  // namespace frm::bake::flow
