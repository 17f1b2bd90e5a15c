#include "bake/flow/kernel.h"

#include "bake/flow/collision.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

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
    Pull p;
    for (int i = 0; i < direction_count; ++i) {
        // The neighbour that a population comes from lies one step against it.
        p.from[i] = from.at(i) + static_cast<std::ptrdiff_t>(first) + grid.offset(opposite(i), k);
    }
    return p;
}

FRM_FLOW_CLONES
void collide(const Pull& in, const Push& out, std::size_t count, const float* __restrict relaxation,
             float smagorinsky, const float* push) {
    const float* const* const from = in.from;
    float* const* const to = out.to;
    const float model = 18 * smagorinsky;
    const float push_x = push[0], push_y = push[1], push_z = push[2];
    FRM_FLOW_INDEPENDENT
    for (std::size_t x = 0; x < count; ++x) {
        const Moments m = moments_of([&](int i) { return from[i][x]; });
        const float keep = 1 - 2 / doubled_relaxation(m, relaxation[x], model);
        collided(m.excess, m.ux + push_x, m.uy + push_y, m.uz + push_z, m.stress.times(keep),
                 [&](int i, float f) { to[i][x] = f; });
    }
}

#if defined(__SSE2__)
constexpr std::size_t chunk = 16 * Grid::lanes;

/// The same, past the caches: a block too large for them is not read again before it has left them, and a line that is
/// written whole need not be fetched first (152 bytes a cell instead of 228).
void collide_past_caches(const Pull& in, const Push& out, std::size_t count, const float* relaxation, float smagorinsky,
                         const float* push) {
    alignas(64) float results[direction_count][chunk];
    Push near;
    for (int i = 0; i < direction_count; ++i) near.to[i] = results[i];
    for (std::size_t first = 0; first < count; first += chunk) {
        const std::size_t size = count - first < chunk ? count - first : chunk;
        Pull from;
        for (int i = 0; i < direction_count; ++i) from.from[i] = in.from[i] + first;
        collide(from, near, size, relaxation + first, smagorinsky, push);
        for (int i = 0; i < direction_count; ++i) {
            float* const to = out.to[i] + first;
            for (std::size_t x = 0; x < size; x += 4) _mm_stream_ps(to + x, _mm_load_ps(results[i] + x));
        }
    }
}
#endif

FRM_FLOW_CLONES
void observe_cells(const Pull& in, std::size_t count, float relaxation, float smagorinsky, float* const* out) {
    const float* const* const from = in.from;
    const float model = 18 * smagorinsky;
    FRM_FLOW_INDEPENDENT
    for (std::size_t x = 0; x < count; ++x) {
        const Moments m = moments_of([&](int i) { return from[i][x]; });
        const Stress strain = m.stress.times(2 / doubled_relaxation(m, relaxation, model));
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
        const Stress strain =
            Stress{in[4][x], in[5][x], in[6][x], in[7][x], in[8][x], in[9][x]}.times(scale);
        // The model's relaxation time from the strain itself: 1/2 + 3 C^2 |S|, |S| = 3/2 root(2 q q) / density.
        const float modelled = 0.5f + model * std::sqrt(2 * strain.square()) / (1 + excess);
        const float time = modelled > relaxation ? modelled : relaxation;
        collided(excess, in[1][x] + push_x, in[2][x] + push_y, in[3][x] + push_z, strain.times(time - 1),
                 [&](int i, float f) { to[i][x] = f; });
    }
}

}  // namespace

void collide_row(const Grid& grid, const Populations& from, Populations& to, std::size_t r, std::size_t first,
                 std::size_t last, const Collision& collision) {
    const std::size_t begin = grid.row(r) + first;
    const Pull in = pull(grid, from, begin, grid.row_z(r));
    Push out;
    for (int i = 0; i < direction_count; ++i) out.to[i] = to.at(i) + begin;
#if defined(__SSE2__)
    if (collision.past_caches) {
        collide_past_caches(in, out, last - first, collision.relaxation + first, collision.smagorinsky, collision.push);
        return;
    }
#endif
    collide(in, out, last - first, collision.relaxation + first, collision.smagorinsky, collision.push);
}

void finish_stores() {
#if defined(__SSE2__)
    _mm_sfence();
#endif
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
