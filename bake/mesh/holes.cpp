#include "bake/mesh/holes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <set>
#include <tuple>

#include "bake/mesh/adjacency.h"
#include "bake/mesh/cuts.h"
#include "bake/mesh/tree.h"

namespace frm::bake {

namespace {

constexpr std::size_t kLongestRim = 200;  // edges; the search for the least area takes their cube
constexpr double kMostWork = 3e8;         // sum of those cubes over all rims: a second or two
constexpr double kFoldCosine = 0.985;     // closer than 10 degrees to the neighbour's own plane, on its side
constexpr double kMargin = 1e-6;          // over the size, as in find_cuts

using Rim = std::vector<std::uint32_t>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;  // low, high

Edge edge(std::uint32_t a, std::uint32_t b) { return std::minmax(a, b); }

double triangle_area(const std::vector<Vec3d>& v, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    return 0.5 * length(cross(v[b] - v[a], v[c] - v[a]));
}

const HalfEdge* find_edge(const std::vector<HalfEdge>& half_edges, const Edge& key) {
    const auto at = std::lower_bound(half_edges.begin(), half_edges.end(), key, [](const HalfEdge& e, const Edge& k) {
        return std::tie(e.low, e.high) < std::tie(k.first, k.second);
    });
    return at != half_edges.end() && at->low == key.first && at->high == key.second ? &*at : nullptr;
}

// The triangulation of least area of a closed chain, by its shorter pieces (Barequet and Sharir 1995): best(i, j) is the
// cheapest filling between the edge i-j and the chain from i to j. Empty where none avoids the edges that are there.
class LeastArea {
public:
    template <typename Allowed>
    LeastArea(const std::vector<Vec3d>& vertices, const Rim& rim, Allowed allowed) : n_(rim.size()), cells_(n_ * n_) {
        constexpr double never = std::numeric_limits<double>::infinity();
        for (std::size_t span = 2; span < n_; ++span) {
            for (std::size_t i = 0; i + span < n_; ++i) {
                const std::size_t j = i + span;
                Cell& cell = at(i, j);
                cell.area = never;
                if (span + 1 < n_ && !allowed(rim[i], rim[j])) continue;
                for (std::size_t k = i + 1; k < j; ++k) {
                    const double area = at(i, k).area + at(k, j).area + triangle_area(vertices, rim[i], rim[k], rim[j]);
                    if (area < cell.area) cell = {area, k};
                }
            }
        }
        if (!std::isfinite(area())) return;
        std::vector<std::pair<std::size_t, std::size_t>> open = {{0, n_ - 1}};
        while (!open.empty()) {
            const auto [i, j] = open.back();
            open.pop_back();
            if (j - i < 2) continue;
            const std::size_t k = at(i, j).middle;
            triangles_.push_back({rim[i], rim[k], rim[j]});
            open.push_back({k, j});
            open.push_back({i, k});
        }
    }

    double area() const { return cells_[n_ - 1].area; }
    std::vector<Triangle>& triangles() { return triangles_; }

private:
    struct Cell {
        double area = 0;
        std::size_t middle = 0;
    };
    Cell& at(std::size_t i, std::size_t j) { return cells_[i * n_ + j]; }

    std::size_t n_;
    std::vector<Cell> cells_;
    std::vector<Triangle> triangles_;
};

class HoleCloser {
public:
    HoleCloser(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& triangles, double size, double area)
        : vertices_(vertices),
          triangles_(triangles),
          half_edges_(sorted_half_edges(triangles)),
          size_(size),
          area_(area) {}

    Holes close() {
        double work = 0, patched = 0;
        for (const Rim& rim : find_rims(triangles_)) {
            // No patch is smaller than the rim's shadow, so most that are too large are known without making one.
            const double extent = rim_extent(vertices_, rim);
            const double crack_area = 0.5 * extent * kCrackWidth * size_;
            const double most = std::min(kHoleArea * area_, extent > kHoleExtent * size_ ? crack_area : HUGE_VAL);
            if (0.5 * length(rim_area(vertices_, rim)) > most) continue;
            const auto n = static_cast<double>(rim.size());
            if (rim.size() > kLongestRim || (work += n * n * n) > kMostWork) continue;
            LeastArea patch(vertices_, rim, [&](std::uint32_t a, std::uint32_t b) {
                return !find_edge(half_edges_, edge(a, b)) && made_.count(edge(a, b)) == 0;
            });
            if (patch.triangles().empty() || patch.area() > most) continue;
            const bool crack = patch.area() <= crack_area;
            if (!is_safe(patch.triangles(), crack)) continue;
            if ((patched += patch.area()) > kAllHolesArea * area_) return {};
            take(patch.triangles(), rim, crack, extent);
        }
        return std::move(result_);
    }

private:
    bool is_safe(const std::vector<Triangle>& patch, bool crack) {
        for (const Triangle& t : patch) {
            for (std::size_t i = 0; i < 3; ++i) {
                if (folds(t[i], t[(i + 1) % 3], t[(i + 2) % 3])) return false;
            }
        }
        if (crack) return true;  // it moves nothing farther than joining vertices does
        if (!tree_) tree_ = std::make_unique<Tree>(vertices_, triangles_);
        for (const Triangle& t : patch) {
            if (cuts(t)) return false;
        }
        return true;
    }

    // Whether the triangle (a, b, c) lies back on the one that the surface has at its edge a-b.
    bool folds(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
        const HalfEdge* half = find_edge(half_edges_, edge(a, b));
        if (!half) return false;
        const std::uint32_t d = triangles_[half->triangle][(half->side + 2) % 3];
        const Vec3d along = vertices_[b] - vertices_[a];
        const double square = dot(along, along);
        if (!(square > 0)) return false;
        const auto height = [&](std::uint32_t v) {
            const Vec3d to = vertices_[v] - vertices_[a];
            return to - along * (dot(to, along) / square);
        };
        const Vec3d mine = height(c), other = height(d);
        const double lm = length(mine), lo = length(other);
        // So low that it closes a crack: its direction says nothing.
        if (lm <= kCrackWidth * size_ || !(lo > 0)) return false;
        return dot(mine, other) > kFoldCosine * lm * lo;
    }

    bool cuts(const Triangle& t) const {
        Box box{vertices_[t[0]], vertices_[t[0]]};
        for (const std::uint32_t v : t) {
            for (int i = 0; i < 3; ++i) {
                box.low[i] = std::min(box.low[i], vertices_[v][i]);
                box.high[i] = std::max(box.high[i], vertices_[v][i]);
            }
        }
        bool found = false;
        tree_->in_box(box, [&](std::uint32_t u) {
            found = triangles_cut(vertices_, t, triangles_[u], kMargin * size_);
            return !found;
        });
        return found;
    }

    void take(std::vector<Triangle>& patch, const Rim& rim, bool crack, double extent) {
        // The patch goes round as the rim; where the surface does so too, one of them must turn.
        const HalfEdge* half = find_edge(half_edges_, edge(rim[0], rim[1]));
        const bool same_way = triangles_[half->triangle][half->side] == rim[0];
        for (Triangle& t : patch) {
            for (std::size_t i = 0; i < 3; ++i) made_.insert(edge(t[i], t[(i + 1) % 3]));
            if (same_way) std::swap(t[1], t[2]);
            result_.patches.push_back(t);
        }
        if ((!crack && extent > result_.widest) || (result_.closed == 0 && result_.cracks == 0))
            result_.place = vertices_[rim[0]];
        if (crack) {
            ++result_.cracks;
        } else {
            ++result_.closed;
            result_.widest = std::max(result_.widest, extent);
        }
    }

    const std::vector<Vec3d>& vertices_;
    const std::vector<Triangle>& triangles_;
    const std::vector<HalfEdge> half_edges_;
    const double size_, area_;
    std::set<Edge> made_;  // by patches so far
    std::unique_ptr<Tree> tree_;
    Holes result_;
};

}  // namespace

std::vector<Rim> find_rims(const std::vector<Triangle>& triangles) {
    // Both directions of each rim edge, by first vertex; `used` marks an edge by its place in either direction.
    const std::vector<HalfEdge> half_edges = sorted_half_edges(triangles);
    std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
    for (std::size_t i = 0, j = 0; i < half_edges.size(); i = j) {
        j = edge_end(half_edges, i);
        if (j - i != 1) continue;
        links.push_back({half_edges[i].low, half_edges[i].high});
        links.push_back({half_edges[i].high, half_edges[i].low});
    }
    std::sort(links.begin(), links.end());
    std::vector<char> used(links.size(), 0);
    const auto first_of = [&](std::uint32_t v) {
        return static_cast<std::size_t>(std::lower_bound(links.begin(), links.end(), std::pair{v, 0u}) - links.begin());
    };
    const auto take = [&](std::size_t link) {
        const auto [a, b] = links[link];
        used[link] = 1;
        used[static_cast<std::size_t>(std::lower_bound(links.begin(), links.end(), std::pair{b, a}) - links.begin())] =
            1;
    };

    std::vector<Rim> rims;
    std::vector<std::uint32_t> path;
    constexpr auto none = std::numeric_limits<std::uint32_t>::max();
    // Of vertex v, at first_of(v): its place in `path`, and the first of its links that may be unused.
    std::vector<std::uint32_t> on_path(links.size(), none);
    std::vector<std::size_t> next_link(links.size());
    std::iota(next_link.begin(), next_link.end(), std::size_t{0});
    for (std::size_t start = 0; start < links.size(); ++start) {
        if (used[start]) continue;
        path.assign(1, links[start].first);
        on_path[first_of(path[0])] = 0;
        while (!path.empty()) {
            const std::uint32_t v = path.back();
            std::size_t& link = next_link[first_of(v)];
            while (link < links.size() && links[link].first == v && used[link]) ++link;
            if (link == links.size() || links[link].first != v) {
                // A dead end, or the start with all its edges used: nothing closed remains on this vertex.
                on_path[first_of(v)] = none;
                path.pop_back();
                continue;
            }
            take(link);
            const std::uint32_t next = links[link].second;
            std::uint32_t& seen = on_path[first_of(next)];
            if (seen == none) {
                seen = static_cast<std::uint32_t>(path.size());
                path.push_back(next);
                continue;
            }
            // Back at a vertex of the path: what lies between is a rim.
            Rim rim(path.begin() + seen, path.end());
            for (std::size_t i = seen + 1u; i < path.size(); ++i) on_path[first_of(path[i])] = none;
            path.resize(seen + 1u);
            if (rim.size() >= 3) rims.push_back(std::move(rim));
        }
    }
    return rims;
}

Vec3d rim_area(const std::vector<Vec3d>& vertices, const std::vector<std::uint32_t>& rim) {
    Vec3d sum;
    for (std::size_t i = 1; i + 1 < rim.size(); ++i)
        sum += cross(vertices[rim[i]] - vertices[rim[0]], vertices[rim[i + 1]] - vertices[rim[0]]);
    return sum;
}

double rim_extent(const std::vector<Vec3d>& vertices, const std::vector<std::uint32_t>& rim) {
    Vec3d low = vertices[rim[0]], high = low;
    for (const std::uint32_t v : rim) {
        for (int i = 0; i < 3; ++i) {
            low[i] = std::min(low[i], vertices[v][i]);
            high[i] = std::max(high[i], vertices[v][i]);
        }
    }
    const Vec3d extent = high - low;
    return std::max({extent.x, extent.y, extent.z});
}

Holes close_holes(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& triangles, double size,
                  double area) {
    return HoleCloser(vertices, triangles, size, area).close();
}

}  // namespace frm::bake
