#include "bake/potential/coarsen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <queue>
#include <utility>
#include <vector>

#include "bake/error.h"
#include "bake/mesh/adjacency.h"

namespace frm::bake {
namespace {

constexpr double flat_limit = 1e-10;  // of a triangle's height to its longest side

// x^T A x + 2 b x + c: the sum of squared distances from planes, weighted by area.
struct Quadric {
    double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
    Vec3d b;
    double c = 0;

    void add_plane(const Vec3d& n, const Vec3d& through, double weight) {
        const double d = -dot(n, through);
        xx += weight * n.x * n.x;
        xy += weight * n.x * n.y;
        xz += weight * n.x * n.z;
        yy += weight * n.y * n.y;
        yz += weight * n.y * n.z;
        zz += weight * n.z * n.z;
        b += n * (weight * d);
        c += weight * d * d;
    }
    void add_point(const Vec3d& p, double weight) {
        xx += weight;
        yy += weight;
        zz += weight;
        b -= p * weight;
        c += weight * dot(p, p);
    }
    Quadric& operator+=(const Quadric& o) {
        xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
        b += o.b;
        c += o.c;
        return *this;
    }
    Vec3d times(const Vec3d& v) const {
        return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
    }
    double at(const Vec3d& v) const { return dot(v, times(v)) + 2 * dot(b, v) + c; }
    // A x = v by the adjugate; false where A is all but singular.
    bool solve(const Vec3d& v, Vec3d& x) const {
        const Vec3d r0(xx, xy, xz), r1(xy, yy, yz), r2(xz, yz, zz);
        const Vec3d c0 = cross(r1, r2), c1 = cross(r2, r0), c2 = cross(r0, r1);
        const double determinant = dot(r0, c0), size = xx + yy + zz;
        if (!(std::abs(determinant) > 1e-12 * size * size * size)) return false;
        x = Vec3d(dot({c0.x, c1.x, c2.x}, v), dot({c0.y, c1.y, c2.y}, v), dot({c0.z, c1.z, c2.z}, v)) / determinant;
        return true;
    }
};

struct Collapse {
    double cost = 0;
    std::uint32_t keep = 0, drop = 0;          // keep < drop
    std::uint32_t keep_age = 0, drop_age = 0;  // of the vertices when this was found
    Vec3d to;

    bool operator<(const Collapse& o) const {
        if (cost != o.cost) return cost > o.cost;
        if (keep != o.keep) return keep > o.keep;
        return drop > o.drop;
    }
};

class Collapsing {
public:
    explicit Collapsing(const Surface& surface)
        : vertices_(surface.vertices),
          triangles_(surface.triangles),
          alive_(triangles_.size()),
          fans_(vertices_.size()),
          quadrics_(vertices_.size()),
          ages_(vertices_.size()) {
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            const Vec3d a = corner(t, 0), n = cross(corner(t, 1) - a, corner(t, 2) - a);
            const double twice = length(n);
            for (const std::uint32_t v : triangles_[t]) {
                fans_[v].push_back(t);
                if (twice > 0) quadrics_[v].add_plane(n / twice, a, twice);
            }
        }
        for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
            for (int i = 0; i < 3; ++i) {
                const std::uint32_t a = triangles_[t][static_cast<std::size_t>(i)];
                const std::uint32_t b = triangles_[t][static_cast<std::size_t>((i + 1) % 3)];
                if (a < b) offer(a, b);
            }
        }
    }

    void run(std::size_t most_triangles) {
        while (alive_ > most_triangles && !waiting_.empty()) {
            Collapse c = waiting_.top();
            waiting_.pop();
            if (fans_[c.drop].empty() || ages_[c.keep] != c.keep_age || ages_[c.drop] != c.drop_age) continue;
            c = collapse(c.keep, c.drop);  // vertices around it may have moved meanwhile
            if (allowed(c)) apply(c);
        }
    }

    Surface take() const {
        Surface result;
        std::vector<std::uint32_t> number(vertices_.size(), none);
        for (const Triangle& t : triangles_) {
            if (t[0] == none) continue;
            Triangle named{};
            for (std::size_t i = 0; i < 3; ++i) {
                if (number[t[i]] == none) {
                    number[t[i]] = static_cast<std::uint32_t>(result.vertices.size());
                    result.vertices.push_back(vertices_[t[i]]);
                }
                named[i] = number[t[i]];
            }
            result.triangles.push_back(named);
        }
        return result;
    }

private:
    static constexpr std::uint32_t none = 0xffffffffu;

    Vec3d corner(std::uint32_t t, std::size_t i) const { return vertices_[triangles_[t][i]]; }
    bool has(std::uint32_t t, std::uint32_t v) const {
        return triangles_[t][0] == v || triangles_[t][1] == v || triangles_[t][2] == v;
    }
    // The two corners of t after v.
    std::pair<std::uint32_t, std::uint32_t> opposite(std::uint32_t t, std::uint32_t v) const {
        const Triangle& c = triangles_[t];
        return c[0] == v   ? std::make_pair(c[1], c[2])
               : c[1] == v ? std::make_pair(c[2], c[0])
                           : std::make_pair(c[0], c[1]);
    }

    void offer(std::uint32_t a, std::uint32_t b) { waiting_.push(collapse(std::min(a, b), std::max(a, b))); }

    // Where the edge's vertex should go, and at what cost.
    Collapse collapse(std::uint32_t keep, std::uint32_t drop) const {
        const Vec3d middle = (vertices_[keep] + vertices_[drop]) * 0.5, edge = vertices_[drop] - vertices_[keep];
        Quadric q = quadrics_[keep];
        q += quadrics_[drop];
        // On a flat part every place is as good: a faint pull to the middle, and shorter edges first.
        const double faint = 1e-4 * (q.xx + q.yy + q.zz);
        q.add_point(middle, faint);
        Vec3d to = middle, step;
        if (q.solve(-(q.times(middle) + q.b), step)) {
            to = middle + step;
            // The same volume: its slope by the place of the new vertex, and what it must be (both six times).
            Vec3d slope, along;
            double volume = 0;
            for (const std::uint32_t v : {keep, drop}) {
                for (const std::uint32_t t : fans_[v]) {
                    const bool goes = has(t, keep) && has(t, drop);
                    const auto [p, r] = opposite(t, v);
                    const Vec3d normal = cross(vertices_[p] - middle, vertices_[r] - middle);
                    if (!goes) slope += normal;
                    if (!goes || v == keep) volume += dot(vertices_[v] - middle, normal);
                }
            }
            if (q.solve(slope, along) && dot(slope, along) > 0) {
                const Vec3d moved = to + along * ((volume - dot(slope, to - middle)) / dot(slope, along));
                if (dot(moved - middle, moved - middle) < dot(edge, edge)) to = moved;
            }
        }
        return {q.at(to) + faint * dot(edge, edge), keep, drop, ages_[keep], ages_[drop], to};
    }

    void neighbours_of(std::uint32_t v, std::vector<std::uint32_t>& out) const {
        out.clear();
        for (const std::uint32_t t : fans_[v]) out.push_back(opposite(t, v).first);
        std::sort(out.begin(), out.end());
    }

    // The surface stays one (Dey et al. 1999: two common neighbours), and no triangle turns over or becomes a needle.
    bool allowed(const Collapse& c) {
        neighbours_of(c.keep, near_keep_);
        neighbours_of(c.drop, near_drop_);
        common_.clear();
        std::set_intersection(near_keep_.begin(), near_keep_.end(), near_drop_.begin(), near_drop_.end(),
                              std::back_inserter(common_));
        if (common_.size() != 2 || fans_[common_[0]].size() <= 3 || fans_[common_[1]].size() <= 3) return false;
        for (const std::uint32_t v : {c.keep, c.drop}) {
            for (const std::uint32_t t : fans_[v]) {
                if (has(t, c.keep) && has(t, c.drop)) continue;
                const auto [p, r] = opposite(t, v);
                const Vec3d side = vertices_[r] - vertices_[p];
                const Vec3d before = cross(vertices_[p] - vertices_[v], vertices_[r] - vertices_[v]);
                const Vec3d after = cross(vertices_[p] - c.to, vertices_[r] - c.to);
                const double length_before = length(before), length_after = length(after);
                const double longest = std::max({dot(side, side), dot(vertices_[p] - c.to, vertices_[p] - c.to),
                                                 dot(vertices_[r] - c.to, vertices_[r] - c.to)});
                if (!(length_after > 1e-3 * longest) && !(length_after > length_before)) return false;
                if (length_before > 1e-9 * longest && !(dot(before, after) > 0.3 * length_before * length_after))
                    return false;
            }
        }
        return true;
    }

    void apply(const Collapse& c) {
        for (const std::uint32_t t : fans_[c.drop]) {
            if (has(t, c.keep)) {
                for (const std::uint32_t v : triangles_[t]) {
                    if (v == c.drop) continue;
                    fans_[v].erase(std::find(fans_[v].begin(), fans_[v].end(), t));
                }
                triangles_[t][0] = none;
                --alive_;
            } else {
                for (std::uint32_t& v : triangles_[t]) {
                    if (v == c.drop) v = c.keep;
                }
                fans_[c.keep].push_back(t);
            }
        }
        fans_[c.drop].clear();
        vertices_[c.keep] = c.to;
        quadrics_[c.keep] += quadrics_[c.drop];
        ++ages_[c.keep];
        neighbours_of(c.keep, near_keep_);
        for (const std::uint32_t v : near_keep_) offer(c.keep, v);
    }

    std::vector<Vec3d> vertices_;
    std::vector<Triangle> triangles_;
    std::size_t alive_;
    std::vector<std::vector<std::uint32_t>> fans_;  // the triangles at each vertex
    std::vector<Quadric> quadrics_;
    std::vector<std::uint32_t> ages_;
    std::priority_queue<Collapse> waiting_;
    std::vector<std::uint32_t> near_keep_, near_drop_, common_;
};

// A triangle whose corners lie on a line has no normal: its longest side is turned to join the two opposite corners,
// which leaves the surface where it is.
void turn_flat_triangles(Surface& surface) {
    const auto height = [&](std::uint32_t t, std::uint32_t& side) {
        double longest = -1;
        for (std::uint32_t i = 0; i < 3; ++i) {
            const Vec3d d = surface.corner(t, static_cast<int>((i + 1) % 3)) - surface.corner(t, static_cast<int>(i));
            if (dot(d, d) > longest) {
                longest = dot(d, d);
                side = i;
            }
        }
        const Vec3d a = surface.corner(t, 0);
        return longest > 0 ? length(cross(surface.corner(t, 1) - a, surface.corner(t, 2) - a)) / longest : 0;
    };
    Neighbours neighbours = find_neighbours(surface, "coarsen");
    for (int pass = 0; pass < 10; ++pass) {
        bool flat = false;
        for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
            std::uint32_t side = 0;
            if (height(t, side) > flat_limit) continue;
            flat = true;
            const std::uint32_t u = neighbours[t][side];
            const std::uint32_t a = surface.triangles[t][side], b = surface.triangles[t][(side + 1) % 3];
            const std::uint32_t c = surface.triangles[t][(side + 2) % 3];
            const std::uint32_t other = surface.triangles[u][0] == b ? 0 : surface.triangles[u][1] == b ? 1 : 2;
            const std::uint32_t d = surface.triangles[u][(other + 2) % 3];
            if (c == d) continue;
            bool joined = false;
            for (const Triangle& s : surface.triangles) {
                const auto has = [&](std::uint32_t v) { return s[0] == v || s[1] == v || s[2] == v; };
                joined = joined || (has(c) && has(d));
            }
            if (joined) continue;
            surface.triangles[t] = {a, d, c};
            surface.triangles[u] = {d, b, c};
            neighbours = find_neighbours(surface, "coarsen");
        }
        if (!flat) return;
    }
}

}  // namespace

Coarse coarsen(const Surface& surface, std::size_t most_triangles) {
    Coarse result{surface, surface.triangles.size() > most_triangles};
    if (result.changed) {
        Collapsing collapsing(surface);
        collapsing.run(most_triangles);
        result.surface = collapsing.take();
    }
    turn_flat_triangles(result.surface);
    return result;
}

}  // namespace frm::bake
