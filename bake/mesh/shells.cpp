#include "bake/mesh/shells.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "bake/mesh/tree.h"

namespace frm::bake {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

bool box_inside(const SurfaceProperties& inner, const SurfaceProperties& outer) {
    for (int i = 0; i < 3; ++i) {
        if (inner.low[i] < outer.low[i] || inner.high[i] > outer.high[i]) return false;
    }
    return true;
}

constexpr std::size_t kMostAngles = 30'000'000;  // solid angles in one search, a second or two

// The step through `count` points that costs no more than that.
std::size_t step_through(std::size_t count, const Surface& surface) {
    return count / std::max<std::size_t>(16, kMostAngles / surface.triangles.size()) + 1;
}

// Takes what it costs from `budget`; what that does not suffice for is not inside.
bool vertices_inside(const Surface& inner, const Surface& outer, std::size_t& budget) {
    const std::size_t step = step_through(inner.vertices.size(), outer);
    for (std::size_t v = 0; v < inner.vertices.size(); v += step) {
        if (budget < outer.triangles.size()) return false;
        budget -= outer.triangles.size();
        if (winding(outer, inner.vertices[v]) < 0.75) return false;
    }
    return true;
}

}  // namespace

// Solid angles of van Oosterom and Strackee (1983).
double winding(const Surface& surface, const Vec3d& point) {
    double angle = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Vec3d a = surface.corner(t, 0) - point;
        const Vec3d b = surface.corner(t, 1) - point;
        const Vec3d c = surface.corner(t, 2) - point;
        const double la = length(a), lb = length(b), lc = length(c);
        angle += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
    }
    return angle / (4 * 3.14159265358979323846);
}

std::vector<Triangle> reaching_outside(const Surface& surface, const std::vector<Vec3d>& vertices,
                                       const std::vector<Triangle>& triangles) {
    std::vector<Triangle> result;
    const std::size_t step = step_through(triangles.size(), surface);
    for (std::size_t i = 0; i < triangles.size(); i += step) {
        const Triangle& t = triangles[i];
        const Vec3d middle = (vertices[t[0]] + vertices[t[1]] + vertices[t[2]]) / 3.0;
        bool outside = winding(surface, middle) < 0.75;
        for (const std::uint32_t v : t)
            outside = outside || winding(surface, vertices[v] + (middle - vertices[v]) * 0.02) < 0.75;
        if (outside) result.push_back(t);
    }
    return result;
}

Shells::Shells(const std::vector<Vec3d>& vertices, std::vector<Triangle> triangles)
    : vertices_(vertices),
      triangles_(std::move(triangles)),
      across_(triangles_.size()),
      shell_(triangles_.size(), kNone) {
    pair_edges();
    if (has_unpaired_) return;
    std::vector<std::uint32_t> queue;
    for (std::uint32_t first = 0; first < triangles_.size(); ++first) {
        if (shell_[first] != kNone) continue;
        shell_[first] = count_;
        queue.assign(1, first);
        while (!queue.empty()) {
            const std::uint32_t t = queue.back();
            queue.pop_back();
            for (const Across& a : across_[t]) {
                if (shell_[a.triangle] != kNone) continue;
                shell_[a.triangle] = count_;
                queue.push_back(a.triangle);
            }
        }
        ++count_;
    }
    members_.resize(count_);
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) members_[shell_[t]].push_back(t);
}

void Shells::pair_edges() {
    const std::vector<HalfEdge> half_edges = sorted_half_edges(triangles_);
    std::vector<std::uint32_t> leader(triangles_.size());
    std::iota(leader.begin(), leader.end(), 0u);
    const auto find = [&](std::uint32_t t) {
        while (leader[t] != t) t = leader[t] = leader[leader[t]];
        return t;
    };
    const auto pair = [&](const HalfEdge& a, const HalfEdge& b) {
        across_[a.triangle][a.side] = {b.triangle, b.side};
        across_[b.triangle][b.side] = {a.triangle, a.side};
    };

    std::vector<std::pair<std::size_t, std::size_t>> crowded;
    for (std::size_t i = 0, j = 0; i < half_edges.size(); i = j) {
        j = edge_end(half_edges, i);
        if (j - i == 2) {
            pair(half_edges[i], half_edges[i + 1]);
            const auto [low, high] = std::minmax({find(half_edges[i].triangle), find(half_edges[i + 1].triangle)});
            leader[high] = low;
        } else {
            crowded.push_back({i, j});
        }
    }

    // Pieces that touch along an edge have two triangles each there, and hang together by their other edges.
    std::vector<std::pair<std::uint32_t, std::size_t>> by_piece;
    for (const auto& [from, to] : crowded) {
        by_piece.clear();
        for (std::size_t i = from; i < to; ++i) by_piece.push_back({find(half_edges[i].triangle), i});
        std::sort(by_piece.begin(), by_piece.end());
        for (std::size_t i = 0; i < by_piece.size(); i += 2) {
            const bool two = i + 1 < by_piece.size() && by_piece[i].first == by_piece[i + 1].first;
            const bool more = i + 2 < by_piece.size() && by_piece[i].first == by_piece[i + 2].first;
            if (!two || more) {
                unpaired_ = half_edges[from];
                has_unpaired_ = true;
                return;
            }
            pair(half_edges[by_piece[i].second], half_edges[by_piece[i + 1].second]);
        }
    }
}

const Triangle* Shells::make_consistent() {
    enum : char { unseen, as_is, flipped };
    std::vector<char> state(triangles_.size(), unseen);
    std::vector<std::uint32_t> queue;
    for (const std::vector<std::uint32_t>& members : members_) {
        std::size_t turns = 0;
        state[members[0]] = as_is;
        queue.assign(1, members[0]);
        while (!queue.empty()) {
            const std::uint32_t t = queue.back();
            queue.pop_back();
            for (std::size_t i = 0; i < 3; ++i) {
                const Across& a = across_[t][i];
                const bool same_way = triangles_[t][i] != triangles_[a.triangle][a.side];
                const char wanted = same_way ? state[t] : static_cast<char>(state[t] == as_is ? flipped : as_is);
                if (state[a.triangle] == unseen) {
                    state[a.triangle] = wanted;
                    turns += wanted == flipped;
                    queue.push_back(a.triangle);
                } else if (state[a.triangle] != wanted) {
                    return &triangles_[t];
                }
            }
        }
        // The majority tells which way the maker meant, and how many triangles are reported as turned.
        const bool minority = 2 * turns > members.size();
        for (const std::uint32_t t : members) {
            if (minority) state[t] = state[t] == flipped ? as_is : flipped;
        }
        turned_ += minority ? members.size() - turns : turns;
    }
    // Sides are numbered by their first corner, so the links across edges end here; nothing uses them any more.
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
        if (state[t] == flipped) std::swap(triangles_[t][1], triangles_[t][2]);
    }
    return nullptr;
}

Surface Shells::piece(std::uint32_t shell) const {
    Surface result;
    std::vector<std::uint32_t> used;
    for (const std::uint32_t t : members_[shell]) used.insert(used.end(), triangles_[t].begin(), triangles_[t].end());
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    for (const std::uint32_t v : used) result.vertices.push_back(vertices_[v]);
    for (const std::uint32_t t : members_[shell]) {
        Triangle triangle = triangles_[t];
        for (std::uint32_t& v : triangle) {
            v = static_cast<std::uint32_t>(std::lower_bound(used.begin(), used.end(), v) - used.begin());
        }
        result.triangles.push_back(triangle);
    }
    return result;
}

SurfaceProperties Shells::properties(std::uint32_t shell) const { return measure(piece(shell)); }

std::uint32_t Shells::turn_outward() {
    std::uint32_t count = 0;
    for (std::uint32_t s = 0; s < count_; ++s) {
        if (properties(s).volume > 0) continue;
        for (const std::uint32_t t : members_[s]) std::swap(triangles_[t][1], triangles_[t][2]);
        ++count;
    }
    return count;
}

std::uint32_t Shells::remove_inner() {
    if (count_ < 2) return 0;
    std::vector<Surface> pieces;
    std::vector<SurfaceProperties> boxes;
    for (std::uint32_t s = 0; s < count_; ++s) {
        pieces.push_back(piece(s));
        boxes.push_back(measure(pieces.back()));
    }
    // A tree over the pieces' boxes, each as a triangle from corner to corner.
    std::vector<Vec3d> corners;
    std::vector<Triangle> diagonals;
    for (std::uint32_t s = 0; s < count_; ++s) {
        corners.push_back(boxes[s].low);
        corners.push_back(boxes[s].high);
        diagonals.push_back({2 * s, 2 * s + 1, 2 * s});
    }
    const Tree tree(corners, diagonals);
    std::vector<char> inner(count_, 0);
    std::size_t budget = 3 * kMostAngles;
    for (std::uint32_t s = 0; s < count_; ++s) {
        tree.in_box({boxes[s].low, boxes[s].low}, [&](std::uint32_t t) {
            if (budget == 0) return false;
            --budget;
            // Less volume: two pieces are never inside each other.
            if (s == t || boxes[s].volume >= boxes[t].volume || !box_inside(boxes[s], boxes[t])) return true;
            inner[s] = vertices_inside(pieces[s], pieces[t], budget);
            return !inner[s];
        });
    }
    std::uint32_t kept = 0;
    for (std::uint32_t s = 0; s < count_; ++s) {
        if (!inner[s]) std::swap(members_[kept++], members_[s]);
    }
    const std::uint32_t removed = count_ - kept;
    members_.resize(kept);
    count_ = kept;
    return removed;
}

Surface Shells::surface() const {
    Surface result;
    for (std::uint32_t s = 0; s < count_; ++s) {
        const Surface part = piece(s);
        const auto base = static_cast<std::uint32_t>(result.vertices.size());
        result.vertices.insert(result.vertices.end(), part.vertices.begin(), part.vertices.end());
        for (const Triangle& t : part.triangles) result.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
    }
    return result;
}

}  // namespace frm::bake
