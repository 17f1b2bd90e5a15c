// Each triangle has two sides. Sides that look at each other around an edge border the same space; joined over all
// edges they give the spaces that the surface divides, and the space that reaches outward is the water.
#include "bake/mesh/walls.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "bake/mesh/adjacency.h"
#include "bake/mesh/shells.h"

namespace frm::bake {

namespace {

constexpr double kSameAngle = 1e-5;  // radians between two triangles at an edge: their order is not known

class Sets {
public:
    explicit Sets(std::size_t count) : leader_(count) { std::iota(leader_.begin(), leader_.end(), 0u); }
    std::uint32_t find(std::uint32_t i) {
        while (leader_[i] != i) i = leader_[i] = leader_[leader_[i]];
        return i;
    }
    void join(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        leader_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::uint32_t> leader_;
};

// Side 2 t of triangle t is the one from which it goes counter-clockwise, 2 t + 1 the other.
std::uint32_t front(std::uint32_t t) { return 2 * t; }
std::uint32_t back(std::uint32_t t) { return 2 * t + 1; }

class Spaces {
public:
    Spaces(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& triangles)
        : vertices_(vertices),
          triangles_(triangles),
          half_edges_(sorted_half_edges(triangles)),
          spaces_(2 * triangles.size()),
          pieces_(triangles.size()) {
        const SurfaceProperties box = measure({vertices, triangles});
        size_ = length(box.high - box.low);
    }

    // False where the order of the triangles around some edge is not clear.
    bool divide() {
        for (std::size_t i = 0, j = 0; i < half_edges_.size(); i = j) {
            j = edge_end(half_edges_, i);
            for (std::size_t k = i + 1; k < j; ++k) pieces_.join(half_edges_[i].triangle, half_edges_[k].triangle);
            if (!join_around(i, j)) return false;
        }
        return true;
    }

    // Triangles by piece (all that hang together by edges), ascending.
    std::vector<std::vector<std::uint32_t>> pieces() {
        std::vector<std::vector<std::uint32_t>> result;
        std::vector<std::uint32_t> number(triangles_.size());
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            const std::uint32_t leader = pieces_.find(t);
            if (leader == t) {
                number[t] = static_cast<std::uint32_t>(result.size());
                result.emplace_back();
            }
            result[number[leader]].push_back(t);
        }
        return result;
    }

    // The space around a piece, as the leader of its sides; false where no clear view from afar was found.
    bool find_outside(const std::vector<std::uint32_t>& piece, std::uint32_t& outside) {
        // Look back along the normals of some triangles, the largest first: the farthest triangle hit is seen from afar.
        std::vector<std::uint32_t> by_size(piece);
        const auto tries = std::min<std::size_t>(piece.size(), 12);
        std::partial_sort(by_size.begin(), by_size.begin() + static_cast<std::ptrdiff_t>(tries), by_size.end(),
                          [&](std::uint32_t a, std::uint32_t b) {
                              const double x = length(normal(a)), y = length(normal(b));
                              return x > y || (x == y && a < b);
                          });
        for (std::size_t i = 0; i < tries; ++i) {
            const Vec3d n = normal(by_size[i]);
            const double norm = length(n);
            if (!(norm > 0)) return false;
            // Off the centroid, so that neither symmetry nor a grid puts an edge in the way every time.
            const Triangle& t = triangles_[by_size[i]];
            const Vec3d from = vertices_[t[0]] * 0.41 + vertices_[t[1]] * 0.33 + vertices_[t[2]] * 0.26;
            if (farthest_side(piece, from, n / norm, outside)) return true;
        }
        return false;
    }

    bool borders(std::uint32_t side, std::uint32_t space) { return spaces_.find(side) == space; }

private:
    Vec3d normal(std::uint32_t t) const {
        const Triangle& c = triangles_[t];
        return cross(vertices_[c[1]] - vertices_[c[0]], vertices_[c[2]] - vertices_[c[0]]);
    }

    bool join_around(std::size_t from, std::size_t to) {
        struct Page {
            double angle;
            std::uint32_t triangle;
            bool front_ahead;  // the front looks the way the angle grows
        };
        std::vector<Page> pages;
        for (std::size_t i = from; i < to; ++i) {
            const HalfEdge& e = half_edges_[i];
            pages.push_back({0, e.triangle, triangles_[e.triangle][e.side] == e.low});
        }
        if (pages.size() > 2) {
            const Vec3d start = vertices_[half_edges_[from].low];
            const Vec3d along = vertices_[half_edges_[from].high] - start;
            const double norm = length(along);
            if (!(norm > 0)) return false;
            const Vec3d axis = along / norm;
            Vec3d u, v;
            for (std::size_t i = from; i < to; ++i) {
                const HalfEdge& e = half_edges_[i];
                const Vec3d tip = vertices_[triangles_[e.triangle][(e.side + 2) % 3]] - start;
                const Vec3d out = tip - axis * dot(tip, axis);
                const double height = length(out);
                if (!(height > 1e-9 * norm)) return false;
                if (i == from) {
                    u = out / height;
                    v = cross(axis, u);
                } else {
                    pages[i - from].angle = std::atan2(dot(out, v), dot(out, u));
                    if (pages[i - from].angle < 0) pages[i - from].angle += 2 * 3.14159265358979323846;
                }
            }
            std::sort(pages.begin(), pages.end(), [](const Page& a, const Page& b) {
                return a.angle < b.angle || (a.angle == b.angle && a.triangle < b.triangle);
            });
            for (std::size_t i = 0; i < pages.size(); ++i) {
                const double next = i + 1 < pages.size() ? pages[i + 1].angle : 2 * 3.14159265358979323846;
                if (next - pages[i].angle < kSameAngle) return false;
            }
        }
        for (std::size_t i = 0; i < pages.size(); ++i) {
            const Page& here = pages[i];
            const Page& next = pages[(i + 1) % pages.size()];
            spaces_.join(here.front_ahead ? front(here.triangle) : back(here.triangle),
                         next.front_ahead ? back(next.triangle) : front(next.triangle));
        }
        return true;
    }

    // The side, seen from afar, of the last triangle on the half-line; false where the line meets an edge or a triangle
    // along its plane.
    bool farthest_side(const std::vector<std::uint32_t>& piece, const Vec3d& from, const Vec3d& direction,
                       std::uint32_t& space) {
        double farthest = -1e-9 * size_;  // its own triangle is at zero, give or take rounding
        bool hit = false;
        for (const std::uint32_t t : piece) {
            const Triangle& c = triangles_[t];
            const Vec3d n = normal(t);
            const double norm = length(n), slope = dot(n, direction);
            if (!(norm > 0)) continue;
            // Where the line passes each side, as shares of the area (Moeller and Trumbore).
            const Vec3d to = vertices_[c[0]] - from;
            const Vec3d e1 = vertices_[c[1]] - vertices_[c[0]], e2 = vertices_[c[2]] - vertices_[c[0]];
            if (std::fabs(slope) < 1e-6 * norm) {
                // Nearly along the plane: only harmless where the line stays clear of it, or of the triangle.
                if (std::fabs(dot(to, n)) <= 1e-5 * size_ * norm && near_line(c, from, direction)) return false;
                continue;
            }
            const double distance = dot(to, n) / slope;
            const Vec3d p = direction * distance - to;
            const double b1 = dot(cross(p, e2), n) / (norm * norm), b2 = dot(cross(e1, p), n) / (norm * norm);
            const double least = std::min({b1, b2, 1 - b1 - b2});
            if (distance < farthest || least < -1e-6) continue;
            if (least < 1e-6) return false;
            farthest = distance;
            hit = true;
            space = spaces_.find(slope > 0 ? front(t) : back(t));
        }
        return hit;
    }

    bool near_line(const Triangle& c, const Vec3d& from, const Vec3d& direction) const {
        const auto off = [&](std::uint32_t v) { return length(cross(vertices_[v] - from, direction)); };
        const double size =
            std::max({length(vertices_[c[1]] - vertices_[c[0]]), length(vertices_[c[2]] - vertices_[c[0]]),
                      length(vertices_[c[2]] - vertices_[c[1]])});
        return std::min({off(c[0]), off(c[1]), off(c[2])}) <= size;
    }

    const std::vector<Vec3d>& vertices_;
    const std::vector<Triangle>& triangles_;
    const std::vector<HalfEdge> half_edges_;
    Sets spaces_, pieces_;
    double size_ = 0;
};

bool is_closed(const std::vector<Triangle>& triangles) {
    const std::vector<HalfEdge> half_edges = sorted_half_edges(triangles);
    for (std::size_t i = 0, j = 0; i < half_edges.size(); i = j) {
        j = edge_end(half_edges, i);
        if ((j - i) % 2 != 0) return false;
    }
    return true;
}

// Whether all of `removed` lie inside what stays.
bool all_inside(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& kept,
                const std::vector<Triangle>& removed) {
    Shells shells(vertices, kept);
    if (shells.unpaired() || shells.make_consistent()) return false;
    shells.turn_outward();
    return reaching_outside(shells.surface(), vertices, removed).empty();
}

}  // namespace

std::vector<Triangle> without_inner_walls(const std::vector<Vec3d>& vertices, const std::vector<Triangle>& triangles) {
    Spaces spaces(vertices, triangles);
    if (!spaces.divide()) return triangles;

    // A triangle of a piece that is all one space is a sheet: it may still lie inside another piece.
    std::vector<char> keep(triangles.size(), 0);
    std::vector<Triangle> removed;
    for (const std::vector<std::uint32_t>& piece : spaces.pieces()) {
        std::uint32_t outside = 0;
        if (!spaces.find_outside(piece, outside)) return triangles;
        bool sheet = true;
        for (const std::uint32_t t : piece) {
            const bool ahead = spaces.borders(front(t), outside), behind = spaces.borders(back(t), outside);
            keep[t] = ahead != behind;
            sheet = sheet && ahead && behind;
        }
        if (sheet) continue;
        // Water on both sides of a part of a piece: a fin or an open part, which is not for us to take away.
        for (const std::uint32_t t : piece) {
            if (spaces.borders(front(t), outside) && spaces.borders(back(t), outside)) return triangles;
        }
    }
    std::vector<Triangle> kept;
    for (std::size_t t = 0; t < triangles.size(); ++t) (keep[t] ? kept : removed).push_back(triangles[t]);
    if (removed.empty() || kept.empty() || !is_closed(kept) || !all_inside(vertices, kept, removed)) return triangles;
    return kept;
}

}  // namespace frm::bake
