#include "bake/flow/kernel.h"

#include "bake/flow/collision.h"

// One row is one loop over contiguous floats: the compiler vectorises it for each instruction set below and the machine
// picks at start-up. All of them give the same bits, because -ffp-contract=off keeps the fused instructions out. This
// file needs -fno-math-errno: without it gcc calls the library for std::sqrt and does not vectorise (8 times slower).
#if defined(__x86_64__) && defined(__linux__) && defined(__GNUC__) && !defined(__clang__)
#define FRM_FLOW_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define FRM_FLOW_CLONES
#endif
#if defined(__clang__)
#define FRM_FLOW_INDEPENDENT _Pragma("clang loop vectorize(assume_safety)")
#elif defined(__GNUC__)
#define FRM_FLOW_INDEPENDENT _Pragma("GCC ivdep")
#else
#define FRM_FLOW_INDEPENDENT
#endif

namespace frm::bake::flow {
namespace {

struct Pull {
    const float* from[direction_count];
};
struct Push {
    float* to[direction_count];
};

Pull pull(const Grid& grid, const Populations& from, std::size_t first, int k) {
    const std::ptrdiff_t y = grid.stride_y(), z = grid.stride_z();
    const std::ptrdiff_t above = (grid.wrap(k + 1) - k) * z, below = (grid.wrap(k - 1) - k) * z;
    const float* const origin = from.at(0) + first;
    const std::ptrdiff_t apart = Populations::apart(grid);
    Pull p;
    for (int i = 0; i < direction_count; ++i) {
        // The neighbour that a population comes from lies one step against it.
        const Direction& c = directions[static_cast<std::size_t>(i)];
        p.from[i] = origin + i * apart - c.x - c.y * y + (c.z > 0 ? below : c.z < 0 ? above : 0);
    }
    return p;
}

constexpr std::size_t chunk = 8 * Grid::lanes;

// In three passes over a chunk that stays in the nearest cache. As one, it is a chain of 500 instructions with two
// divisions and two roots in it, too long for the processor to work on the next cells meanwhile (a seventh slower on
// a Zen 5 core).
template <bool turns>
FRM_FLOW_INLINE void collide_cells(const Pull& in, const Push& out, std::size_t count,
                                   const float* __restrict relaxation, float smagorinsky, const float* push,
                                   const Turning& turning, float y) {
    const float* const* const from = in.from;
    float* const* const to = out.to;
    const float model = 18 * smagorinsky;
    const float push_x = push[0], push_y = push[1], push_z = push[2];
    alignas(64) float excess[chunk], ux[chunk], uy[chunk], uz[chunk], keep[chunk];
    alignas(64) float xx[chunk], yy[chunk], zz[chunk], xy[chunk], xz[chunk], yz[chunk];
    for (std::size_t first = 0; first < count; first += chunk) {
        const std::size_t size = count - first < chunk ? count - first : chunk;
        FRM_FLOW_INDEPENDENT
        for (std::size_t x = 0; x < size; ++x) {
            const Moments m = moments_of([&](int i) { return from[i][first + x]; });
            excess[x] = m.excess;
            if constexpr (turns) {
                const Turning::Kick kick = turning.kick(m.ux, m.uy, static_cast<float>(static_cast<int>(first + x)), y);
                ux[x] = m.ux + kick.x;
                uy[x] = m.uy + kick.y;
                uz[x] = m.uz;
            } else {
                ux[x] = m.ux + push_x;
                uy[x] = m.uy + push_y;
                uz[x] = m.uz + push_z;
            }
            xx[x] = m.stress.xx;
            yy[x] = m.stress.yy;
            zz[x] = m.stress.zz;
            xy[x] = m.stress.xy;
            xz[x] = m.stress.xz;
            yz[x] = m.stress.yz;
            keep[x] = m.stress.square();
        }
        FRM_FLOW_INDEPENDENT
        for (std::size_t x = 0; x < size; ++x) {
            keep[x] = 1 - 2 / doubled_relaxation(excess[x], keep[x], relaxation[first + x], model);
        }
        FRM_FLOW_INDEPENDENT
        for (std::size_t x = 0; x < size; ++x) {
            const Stress q = Stress{xx[x], yy[x], zz[x], xy[x], xz[x], yz[x]}.times(keep[x]);
            collided(excess[x], ux[x], uy[x], uz[x], q, [&](int i, float f) { to[i][first + x] = f; });
        }
    }
}

FRM_FLOW_CLONES
void collide(const Pull& in, const Push& out, std::size_t count, const float* relaxation, float smagorinsky,
             const float* push) {
    collide_cells<false>(in, out, count, relaxation, smagorinsky, push, {}, 0);
}

FRM_FLOW_CLONES
void collide_turning(const Pull& in, const Push& out, std::size_t count, const float* relaxation, float smagorinsky,
                     const Turning& turning, float y) {
    const float none[3] = {};
    const Turning t = turning;  // nothing that is stored can change it
    collide_cells<true>(in, out, count, relaxation, smagorinsky, none, t, y);
}

FRM_FLOW_CLONES
void observe_cells(const Pull& in, std::size_t count, float relaxation, float smagorinsky, float* const* out) {
    const float* const* const from = in.from;
    const float model = 18 * smagorinsky;
    FRM_FLOW_INDEPENDENT
    for (std::size_t x = 0; x < count; ++x) {
        const Moments m = moments_of([&](int i) { return from[i][x]; });
        const Stress strain = m.stress.times(2 / doubled_relaxation(m.excess, m.stress.square(), relaxation, model));
        out[0][x] = m.excess;
        out[1][x] = m.ux;
        out[2][x] = m.uy;
        out[3][x] = m.uz;
        out[4][x] = strain.xx;
        out[5][x] = strain.yy;
        out[6][x] = strain.zz;
        out[7][x] = strain.xy;
        out[8][x] = strain.xz;
        out[9][x] = strain.yz;
    }
}

FRM_FLOW_CLONES
void rebuild_cells(const float* const* in, std::size_t count, float scale, float relaxation, float smagorinsky,
                   const float* push, float* const* to) {
    const float model = 4.5f * smagorinsky;
    const float push_x = push[0], push_y = push[1], push_z = push[2];
    FRM_FLOW_INDEPENDENT
    for (std::size_t x = 0; x < count; ++x) {
        const float excess = in[0][x];
        const Stress strain = Stress{in[4][x], in[5][x], in[6][x], in[7][x], in[8][x], in[9][x]}.times(scale);
        // The model's relaxation time from the strain itself: 1/2 + 3 C^2 |S|, |S| = 3/2 root(2 q q) / density.
        const float modelled = 0.5f + model * std::sqrt(2 * strain.square()) / (1 + excess);
        const float time = modelled > relaxation ? modelled : relaxation;
        collided(excess, in[1][x] + push_x, in[2][x] + push_y, in[3][x] + push_z, strain.times(time - 1),
                 [&](int i, float f) { to[i][x] = f; });
    }
}

}  // namespace

void collide_row(const Grid& grid, const Populations& from, Populations& to, std::size_t r,
                 const Collision& collision) {
    const std::size_t first = grid.row(r);
    const Pull in = pull(grid, from, first, grid.row_z(r));
    Push out;
    for (int i = 0; i < direction_count; ++i) out.to[i] = to.at(i) + first;
    collide(in, out, grid.pitch(), collision.relaxation, collision.smagorinsky, collision.push);
}

void collide_row(const Grid& grid, const Populations& from, Populations& to, std::size_t r, const Collision& collision,
                 const Turning& turning) {
    const std::size_t first = grid.row(r);
    const Pull in = pull(grid, from, first, grid.row_z(r));
    Push out;
    for (int i = 0; i < direction_count; ++i) out.to[i] = to.at(i) + first;
    collide_turning(in, out, grid.pitch(), collision.relaxation, collision.smagorinsky, turning,
                    static_cast<float>(grid.row_y(r)));
}

void observe(const Grid& grid, const Populations& from, int i, int j, int k, std::size_t count, float relaxation,
             float smagorinsky, const Fields& fields) {
    observe_cells(pull(grid, from, grid.index(i, j, k), k), count, relaxation, smagorinsky, fields.data());
}

void rebuild(const ConstFields& fields, std::size_t count, float scale, float relaxation, float smagorinsky,
             const float* push, const std::array<float*, direction_count>& out) {
    rebuild_cells(fields.data(), count, scale, relaxation, smagorinsky, push, out.data());
}

}  // namespace frm::bake::flow
