#include "bake/flow/kernel.h"

#include <algorithm>

#include "bake/flow/collision.h"
#include "bake/flow/vectors.h"

// This file needs -fno-math-errno: without it gcc calls the library for std::sqrt and does not vectorise (8 times
// slower).
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

/// What some cells of a row say, in memory that stays in the nearest cache.
struct Chunk {
    alignas(64) float excess[chunk], ux[chunk], uy[chunk], uz[chunk];
    alignas(64) float xx[chunk], yy[chunk], zz[chunk], xy[chunk], xz[chunk], yz[chunk];
    alignas(64) float rate[chunk];  // of relaxation
};

/// The cells that come after these: a processor follows fewer streams than the 38 of a row by itself (docs/flow.md,
/// "Speed").
FRM_FLOW_INLINE void ask_for_row(const float* const* cells, std::size_t first, std::size_t size) {
    for (int i = 0; i < direction_count; ++i) {
        for (std::size_t x = 0; x < size; x += Grid::lanes) ask_for_later(cells[i] + first + x);
    }
}

/// `relaxation(x)`: the molecular time of the chunk's cell x.
template <typename Relaxation>
FRM_FLOW_INLINE void read_moments(const float* const* from, std::size_t first, std::size_t size,
                                  const Relaxation& relaxation, float model, Chunk& c) {
    FRM_FLOW_INDEPENDENT
    for (std::size_t x = 0; x < size; ++x) {
        const Moments m = moments_of([&](int i) { return from[i][first + x]; });
        c.excess[x] = m.excess;
        c.ux[x] = m.ux;
        c.uy[x] = m.uy;
        c.uz[x] = m.uz;
        c.xx[x] = m.stress.xx;
        c.yy[x] = m.stress.yy;
        c.zz[x] = m.stress.zz;
        c.xy[x] = m.stress.xy;
        c.xz[x] = m.stress.xz;
        c.yz[x] = m.stress.yz;
        c.rate[x] = m.stress.square();
    }
    FRM_FLOW_INDEPENDENT
    for (std::size_t x = 0; x < size; ++x) {
        c.rate[x] = 2 / doubled_relaxation(c.excess[x], c.rate[x], relaxation(x), model);
    }
}

/// Cells begin to end of the chunk, as cell `first` of `out` and on.
FRM_FLOW_INLINE void copy_fields(const Chunk& c, std::size_t begin, std::size_t end, float* const* out,
                                 std::size_t first) {
    FRM_FLOW_INDEPENDENT
    for (std::size_t x = begin; x < end; ++x) {
        out[0][first + x - begin] = c.excess[x];
        out[1][first + x - begin] = c.ux[x];
        out[2][first + x - begin] = c.uy[x];
        out[3][first + x - begin] = c.uz[x];
        out[4][first + x - begin] = c.rate[x] * c.xx[x];
        out[5][first + x - begin] = c.rate[x] * c.yy[x];
        out[6][first + x - begin] = c.rate[x] * c.zz[x];
        out[7][first + x - begin] = c.rate[x] * c.xy[x];
        out[8][first + x - begin] = c.rate[x] * c.xz[x];
        out[9][first + x - begin] = c.rate[x] * c.yz[x];
    }
}

// In passes over a chunk. As one, it is a chain of 500 instructions with two divisions and two roots in it, too long for
// the processor to work on the next cells meanwhile (a seventh slower on a Zen 5 core).
template <bool turns>
FRM_FLOW_INLINE void collide_cells(const Pull& in, const Push& out, std::size_t count,
                                   const float* __restrict relaxation, float smagorinsky, const float* push,
                                   const Turning& turning, float y, const Wanted& wanted) {
    float* const* const to = out.to;
    const float push_x = push[0], push_y = push[1], push_z = push[2];
    Chunk c;
    for (std::size_t first = 0; first < count; first += chunk) {
        const std::size_t size = count - first < chunk ? count - first : chunk;
        ask_for_row(in.from, first + size, size);
        ask_for_row(to, first + size, size);
        read_moments(
            in.from, first, size, [&](std::size_t x) { return relaxation[first + x]; }, 18 * smagorinsky, c);
        for (std::size_t n = 0; n < wanted.count; ++n) {
            const Wanted::Cells& cells = wanted.cells[n];
            const std::size_t begin = std::max(cells.begin, first), end = std::min(cells.end, first + size);
            if (begin < end) copy_fields(c, begin - first, end - first, cells.to.data(), begin - cells.begin);
        }
        FRM_FLOW_INDEPENDENT
        for (std::size_t x = 0; x < size; ++x) {
            float ux = c.ux[x], uy = c.uy[x], uz = c.uz[x];
            if constexpr (turns) {
                const Turning::Kick kick = turning.kick(ux, uy, static_cast<float>(static_cast<int>(first + x)), y);
                ux += kick.x;
                uy += kick.y;
            } else {
                ux += push_x;
                uy += push_y;
                uz += push_z;
            }
            const Stress q = Stress{c.xx[x], c.yy[x], c.zz[x], c.xy[x], c.xz[x], c.yz[x]}.times(1 - c.rate[x]);
            collided(c.excess[x], ux, uy, uz, q, [&](int i, float f) { to[i][first + x] = f; });
        }
    }
}

FRM_FLOW_CLONES
void collide(const Pull& in, const Push& out, std::size_t count, const float* relaxation, float smagorinsky,
             const float* push, const Wanted& wanted) {
    collide_cells<false>(in, out, count, relaxation, smagorinsky, push, {}, 0, wanted);
}

FRM_FLOW_CLONES
void collide_turning(const Pull& in, const Push& out, std::size_t count, const float* relaxation, float smagorinsky,
                     const Turning& turning, float y, const Wanted& wanted) {
    const float none[3] = {};
    const Turning t = turning;  // nothing that is stored can change it
    collide_cells<true>(in, out, count, relaxation, smagorinsky, none, t, y, wanted);
}

FRM_FLOW_CLONES
void observe_cells(const Pull& in, std::size_t count, float relaxation, float smagorinsky, float* const* out) {
    Chunk c;
    for (std::size_t first = 0; first < count; first += chunk) {
        const std::size_t size = count - first < chunk ? count - first : chunk;
        read_moments(
            in.from, first, size, [&](std::size_t) { return relaxation; }, 18 * smagorinsky, c);
        copy_fields(c, 0, size, out, first);
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

void collide_row(const Grid& grid, const Populations& from, Populations& to, std::size_t r, const Collision& collision,
                 const Wanted& wanted) {
    const std::size_t first = grid.row(r);
    const Pull in = pull(grid, from, first, grid.row_z(r));
    Push out;
    for (int i = 0; i < direction_count; ++i) out.to[i] = to.at(i) + first;
    collide(in, out, grid.pitch(), collision.relaxation, collision.smagorinsky, collision.push, wanted);
}

void collide_row(const Grid& grid, const Populations& from, Populations& to, std::size_t r, const Collision& collision,
                 const Wanted& wanted, const Turning& turning) {
    const std::size_t first = grid.row(r);
    const Pull in = pull(grid, from, first, grid.row_z(r));
    Push out;
    for (int i = 0; i < direction_count; ++i) out.to[i] = to.at(i) + first;
    collide_turning(in, out, grid.pitch(), collision.relaxation, collision.smagorinsky, turning,
                    static_cast<float>(grid.row_y(r)), wanted);
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
