#include "core/body/volume_elements.h"

#include <algorithm>
#include <cmath>

namespace frm {
namespace {

constexpr std::int32_t longest_side = 128;       ///< of the lattice, in elements
constexpr std::int32_t most_elements = 1 << 18;  ///< of the lattice, empty ones too
/// Of the finest elements, in cells of their level. With whole ones, a hull that is towed turned against the grid leaves
/// ripples of two cells ten times as high behind.
constexpr double finest_edge = 0.5;
constexpr std::int32_t rays = 4;        ///< through an element, along each side of it
constexpr double ray_offset = 0.50013;  ///< of a ray in its share: off the middle, where edges like to lie

/// Volume of a lattice cell, its first and its second moments (about the lattice's own origin).
struct Moment {
    double volume = 0;
    Vec3d first, second;

    void add(const Moment& o) {
        volume += o.volume;
        first += o.first;
        second += o.second;
    }
};

struct Lattice {
    std::int32_t n[3];
    Vec3d low, edge;
    std::pmr::vector<Moment> cell;

    Moment& at(std::int32_t i, std::int32_t j, std::int32_t k) {
        return cell[(static_cast<std::size_t>(k) * static_cast<std::size_t>(n[1]) + static_cast<std::size_t>(j)) *
                        static_cast<std::size_t>(n[0]) +
                    static_cast<std::size_t>(i)];
    }
};

/// The volume below a point of the surface, in a column of cross section `share`: what faces up ends the body there, what
/// faces down begins it.
void add_column(Lattice& lattice, std::int32_t i, std::int32_t j, double x, double y, double z, double share) {
    for (std::int32_t k = 0; k < lattice.n[2]; ++k) {
        const double low = lattice.low.z + k * lattice.edge.z;
        if (!(z > low)) break;
        const double high = std::min(z, low + lattice.edge.z), v = share * (high - low);
        Moment m;
        m.volume = v;
        m.first = Vec3d(x, y, 0.5 * (low + high)) * v;
        // The column's own width counts: the rays' shares are boxes.
        const double dx = lattice.edge.x / rays, dy = lattice.edge.y / rays;
        m.second = {v * (x * x + dx * dx / 12), v * (y * y + dy * dy / 12),
                    v * ((high * high + high * low + low * low) / 3)};
        lattice.at(i, j, k).add(m);
    }
}

/// Which side of the edge from a to b the point is, the same number for both triangles that share the edge; `turned` where
/// it runs the other way, so that a ray through the edge meets one of the two.
bool left_of(const Vec3f& pa, const Vec3f& pb, std::uint32_t a, std::uint32_t b, double x, double y) {
    const bool turned = a > b;
    const Vec3f &p = turned ? pb : pa, &q = turned ? pa : pb;
    const double px = static_cast<double>(p.x), py = static_cast<double>(p.y);
    const double side = (static_cast<double>(q.x) - px) * (y - py) - (static_cast<double>(q.y) - py) * (x - px);
    return turned ? !(side >= 0) : side >= 0;
}

void shoot(const Map& map, Lattice& lattice) {
    const double dx = lattice.edge.x / rays, dy = lattice.edge.y / rays;
    const auto range = [](double low, double high, double from, double step, std::int32_t count, std::int32_t& first,
                          std::int32_t& last) {
        first = std::max(0, static_cast<std::int32_t>((low - from) / step) - 1);
        last = std::min(count - 1, static_cast<std::int32_t>((high - from) / step) + 1);
    };
    for (const auto& t : map.triangles) {
        const Vec3f &a = map.vertices[t[0]], &b = map.vertices[t[1]], &c = map.vertices[t[2]];
        const Vec3d n = cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
        if (n.z == 0) continue;
        std::int32_t i0, i1, j0, j1;
        range(static_cast<double>(std::min({a.x, b.x, c.x})), static_cast<double>(std::max({a.x, b.x, c.x})),
              lattice.low.x, dx, lattice.n[0] * rays, i0, i1);
        range(static_cast<double>(std::min({a.y, b.y, c.y})), static_cast<double>(std::max({a.y, b.y, c.y})),
              lattice.low.y, dy, lattice.n[1] * rays, j0, j1);
        for (std::int32_t j = j0; j <= j1; ++j) {
            const double y = lattice.low.y + (j + ray_offset) * dy;
            for (std::int32_t i = i0; i <= i1; ++i) {
                const double x = lattice.low.x + (i + ray_offset) * dx;
                const bool ab = left_of(a, b, t[0], t[1], x, y), bc = left_of(b, c, t[1], t[2], x, y),
                           ca = left_of(c, a, t[2], t[0], x, y);
                if (n.z > 0 ? !(ab && bc && ca) : ab || bc || ca) continue;
                const double z = static_cast<double>(a.z) -
                                 (n.x * (x - static_cast<double>(a.x)) + n.y * (y - static_cast<double>(a.y))) / n.z;
                add_column(lattice, i / rays, j / rays, x, y, z, n.z > 0 ? dx * dy : -dx * dy);
            }
        }
    }
}

void put(VolumeElements::Blocks& blocks, std::size_t number, const Moment& m, const Vec3d& centre, double factor) {
    const std::size_t lane = number % kernel_lanes;
    if (lane == 0) blocks.push_back(VolumeElements::Block{});
    ElementBlock& e = blocks.back().element;
    const Vec3d mean = m.first / m.volume;
    e.x[lane] = static_cast<float>(mean.x - centre.x);
    e.y[lane] = static_cast<float>(mean.y - centre.y);
    e.z[lane] = static_cast<float>(mean.z - centre.z);
    e.volume[lane] = static_cast<float>(m.volume * factor);
    for (int k = 0; k < 3; ++k)
        e.spread[k][lane] = static_cast<float>(std::max(0.0, 3 * (m.second[k] / m.volume - mean[k] * mean[k])));
}

/// Empty lanes take the first's place, and the box is that of all.
void close(VolumeElements::Block& block) {
    ElementBlock& e = block.element;
    const float* place[3] = {e.x, e.y, e.z};
    float low[3] = {}, high[3] = {};
    for (std::size_t lane = 0; lane < kernel_lanes; ++lane) {
        if (!(e.volume[lane] > 0)) e.x[lane] = e.x[0], e.y[lane] = e.y[0], e.z[lane] = e.z[0];
        for (std::size_t k = 0; k < 3; ++k) {
            const float half = std::sqrt(e.spread[k][lane]);
            const float l = place[k][lane] - half, h = place[k][lane] + half;
            low[k] = lane == 0 ? l : std::min(low[k], l);
            high[k] = lane == 0 ? h : std::max(high[k], h);
        }
    }
    for (std::size_t k = 0; k < 3; ++k) {
        block.centre[k] = 0.5f * (low[k] + high[k]);
        block.half[k] = 0.5f * (high[k] - low[k]) * 1.001f;
    }
}

}  // namespace

VolumeElements::VolumeElements(const Map& map, float cell, int levels, std::pmr::memory_resource* memory)
    : level_{{Blocks(memory), Blocks(memory), Blocks(memory), Blocks(memory), Blocks(memory), Blocks(memory),
              Blocks(memory)}} {
    const Vec3d low(map.shape.low), size = Vec3d(map.shape.high) - low;
    Lattice lattice{{}, low, {}, std::pmr::vector<Moment>(memory)};
    for (;; ++finest_) {
        const double edge = finest_edge * static_cast<double>(cell) * (1 << finest_);
        std::int64_t all = 1;
        bool fits = true;
        for (int k = 0; k < 3; ++k) {
            const double wanted = std::ceil(size[k] / edge - 1e-3);
            fits &= wanted <= longest_side;
            lattice.n[k] = static_cast<std::int32_t>(std::clamp(wanted, 1.0, static_cast<double>(longest_side)));
            all *= lattice.n[k];
        }
        if ((fits && all <= most_elements) || finest_ == levels - 1) break;
    }
    // A body of many times the window: larger elements than the coarsest cells, never more of them.
    while (std::int64_t{lattice.n[0]} * lattice.n[1] * lattice.n[2] > most_elements)
        for (std::int32_t& n : lattice.n) n = (n + 1) / 2;
    for (int k = 0; k < 3; ++k) lattice.edge[k] = std::max(size[k], 1e-12) / lattice.n[k];
    lattice.cell.resize(static_cast<std::size_t>(lattice.n[0]) * static_cast<std::size_t>(lattice.n[1]) *
                        static_cast<std::size_t>(lattice.n[2]));
    shoot(map, lattice);

    const Vec3d centre(map.clusters.centre);
    const double least = 1e-9 * map.shape.volume;
    for (int level = finest_; level < levels; ++level) {
        // The first coarser level has whole cells: four of the finest edges.
        for (int times = level == finest_ ? 0 : level == finest_ + 1 ? 2 : 1; times > 0; --times) {
            Lattice coarse{{(lattice.n[0] + 1) / 2, (lattice.n[1] + 1) / 2, (lattice.n[2] + 1) / 2},
                           low,
                           lattice.edge * 2.0,
                           std::pmr::vector<Moment>(memory)};
            coarse.cell.resize(static_cast<std::size_t>(coarse.n[0]) * static_cast<std::size_t>(coarse.n[1]) *
                               static_cast<std::size_t>(coarse.n[2]));
            for (std::int32_t k = 0; k < lattice.n[2]; ++k)
                for (std::int32_t j = 0; j < lattice.n[1]; ++j)
                    for (std::int32_t i = 0; i < lattice.n[0]; ++i)
                        coarse.at(i / 2, j / 2, k / 2).add(lattice.at(i, j, k));
            lattice = std::move(coarse);
        }
        // What rays miss is made up for: the volume is the surface's.
        double sum = 0;
        for (const Moment& m : lattice.cell)
            if (m.volume > least) sum += m.volume;
        const double factor = sum > 0 ? map.shape.volume / sum : 0;
        Blocks& blocks = level_[static_cast<std::size_t>(level)];
        std::size_t number = 0;
        // Bricks of four by four by four, so that sixteen in a row lie together.
        for (std::int32_t bk = 0; bk < lattice.n[2]; bk += 4)
            for (std::int32_t bj = 0; bj < lattice.n[1]; bj += 4)
                for (std::int32_t bi = 0; bi < lattice.n[0]; bi += 4)
                    for (std::int32_t k = bk; k < std::min(bk + 4, lattice.n[2]); ++k)
                        for (std::int32_t j = bj; j < std::min(bj + 4, lattice.n[1]); ++j)
                            for (std::int32_t i = bi; i < std::min(bi + 4, lattice.n[0]); ++i)
                                if (const Moment& m = lattice.at(i, j, k); m.volume > least)
                                    put(blocks, number++, m, centre, factor);
        for (Block& block : blocks) close(block);
    }
}

}  // namespace frm
