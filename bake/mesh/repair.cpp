#include "bake/mesh/repair.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <tuple>

#include "bake/mesh/adjacency.h"
#include "bake/mesh/holes.h"
#include "bake/mesh/refusals.h"
#include "bake/mesh/shells.h"
#include "bake/mesh/walls.h"
#include "bake/mesh/weld.h"

namespace frm::bake {

namespace {

constexpr double kJoin[] = {1e-6, 1e-5, 1e-4};  // of the size; wider only where the surface is open otherwise
constexpr double kFlat = 1e-5;                  // mean thickness over size: under this there is no volume to speak of

// The soup after joining vertices, with what was left out on the way.
struct Candidate {
    double join = 0;
    std::vector<Triangle> triangles;
    std::size_t collapsed = 0, copies = 0, inner = 0;
    std::vector<Triangle> walls;  // removed because they lay back to back
    Holes holes;                  // closed
    std::size_t odd_edges = 0;    // edges with an odd number of triangles; 0: closed

    bool better_than(const Candidate& other) const { return odd_edges < other.odd_edges; }
};

std::size_t count_odd_edges(const std::vector<Triangle>& triangles) {
    const std::vector<HalfEdge> half_edges = sorted_half_edges(triangles);
    std::size_t odd = 0;
    for (std::size_t i = 0, j = 0; i < half_edges.size(); i = j) {
        j = edge_end(half_edges, i);
        odd += (j - i) % 2;
    }
    return odd;
}

// Triangles on the same three vertices are copies (a face for each side), or the wall left where two pieces share a
// face. Only what remains can tell: with one of each kept a copy closes and a wall does not.
Candidate without_repeats(const Candidate& from) {
    std::vector<std::pair<Triangle, std::uint32_t>> sorted(from.triangles.size());
    for (std::uint32_t t = 0; t < sorted.size(); ++t) {
        Triangle key = from.triangles[t];
        std::sort(key.begin(), key.end());
        sorted[t] = {key, t};
    }
    std::sort(sorted.begin(), sorted.end());
    std::vector<char> keep_one(sorted.size(), 1), keep_odd(sorted.size(), 1);
    std::size_t copies = 0;
    for (std::size_t i = 0, j = 0; i < sorted.size(); i = j) {
        while (j < sorted.size() && sorted[j].first == sorted[i].first) ++j;
        for (std::size_t k = i + 1; k < j; ++k) keep_one[sorted[k].second] = keep_odd[sorted[k].second] = 0;
        if ((j - i) % 2 == 0) keep_odd[sorted[i].second] = 0;
        copies += j - i - 1;
    }
    const auto kept = [&](const std::vector<char>& keep) {
        Candidate result;
        result.join = from.join;
        result.collapsed = from.collapsed;
        for (std::size_t t = 0; t < keep.size(); ++t) {
            if (keep[t]) result.triangles.push_back(from.triangles[t]);
        }
        result.odd_edges = count_odd_edges(result.triangles);
        return result;
    };
    Candidate one = kept(keep_one);
    one.copies = copies;
    if (copies == 0 || one.odd_edges == 0) return one;
    Candidate odd = kept(keep_odd);
    for (std::size_t t = 0; t < keep_odd.size(); ++t) {
        if (!keep_odd[t]) odd.walls.push_back(from.triangles[t]);
    }
    return odd.better_than(one) ? odd : one;
}

Candidate join_vertices(const Surface& soup, double join) {
    const std::vector<std::uint32_t> first = weld_vertices(soup.vertices, join);
    Candidate result;
    result.join = join;
    for (const Triangle& t : soup.triangles) {
        const Triangle joined = {first[t[0]], first[t[1]], first[t[2]]};
        if (joined[0] == joined[1] || joined[1] == joined[2] || joined[2] == joined[0]) {
            ++result.collapsed;
        } else {
            result.triangles.push_back(joined);
        }
    }
    return without_repeats(result);
}

// Closes what is still open as far as that is safe: tiny holes, then walls inside.
Candidate closed_further(const Surface& soup, Candidate c, double size) {
    c.holes = close_holes(soup.vertices, c.triangles, size, measure({soup.vertices, c.triangles}).area);
    c.triangles.insert(c.triangles.end(), c.holes.patches.begin(), c.holes.patches.end());
    c.odd_edges = count_odd_edges(c.triangles);
    if (c.odd_edges == 0) return c;
    std::vector<Triangle> skin = without_inner_walls(soup.vertices, c.triangles);
    c.inner = c.triangles.size() - skin.size();
    c.triangles = std::move(skin);
    c.odd_edges = count_odd_edges(c.triangles);
    return c;
}

// With the least of joining, patching and removing that closes the surface; the closest to closed if nothing does.
Candidate close_surface(const Surface& soup, double size) {
    std::vector<Candidate> candidates;
    for (const double join : kJoin) {
        candidates.push_back(join_vertices(soup, join * size));
        if (candidates.back().odd_edges == 0) return candidates.back();
    }
    std::size_t best = 0;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        candidates[i] = closed_further(soup, std::move(candidates[i]), size);
        if (candidates[i].odd_edges == 0) return candidates[i];
        if (candidates[i].better_than(candidates[best])) best = i;
    }
    return candidates[best];
}

void note_closing(const Candidate& c, double size, std::vector<std::string>& notes) {
    if (c.join > kJoin[0] * size) {
        notes.push_back("joined vertices up to " + length_text(c.join) + " apart to close the surface");
    }
    if (c.collapsed) notes.push_back("removed " + count_of(c.collapsed, "triangle") + " without area");
    if (c.copies) notes.push_back("removed " + count_of(c.copies, "repeated triangle"));
    if (!c.walls.empty())
        notes.push_back("removed " + count_of(c.walls.size(), "triangle") +
                        " lying back to back (walls between pieces)");
    if (c.holes.closed) {
        notes.push_back("closed " + count_of(c.holes.closed, "hole") + " of at most " + length_text(c.holes.widest) +
                        ", near " + place(c.holes.place));
    }
    if (c.holes.cracks) {
        notes.push_back("closed " + count_of(c.holes.cracks, "crack") + " under " + length_text(kCrackWidth * size) +
                        " wide on average" + (c.holes.closed ? std::string() : ", near " + place(c.holes.place)));
    }
    if (c.inner) {
        notes.push_back("removed " + count_of(c.inner, "triangle") +
                        " of walls inside the shape (water cannot reach them)");
    }
}

void note_cuts(const Cuts& cuts, std::vector<std::string>& notes) {
    if (cuts.within) {
        notes.push_back("the surface cuts through itself: " + count_of(cuts.within, "pair") + " of triangles, near " +
                        place(cuts.within_at) +
                        "; the flow does not mind, but volume and buoyancy count what overlaps twice");
    }
    if (cuts.between) {
        notes.push_back("pieces run into each other: " + count_of(cuts.between, "pair") + " of triangles, near " +
                        place(cuts.between_at) +
                        "; the flow does not mind, but volume and buoyancy count what overlaps twice");
    }
    if (!cuts.complete) notes.push_back("whether the surface cuts through itself was not looked at everywhere");
}

bool is_planar(const Surface& soup, const std::vector<Triangle>& triangles, double size) {
    Vec3d normal, on_plane;
    for (const Triangle& t : triangles) {
        const Vec3d a = soup.vertices[t[0]];
        const Vec3d n = cross(soup.vertices[t[1]] - a, soup.vertices[t[2]] - a);
        if (dot(n, n) > dot(normal, normal)) {
            normal = n;
            on_plane = a;
        }
    }
    const double norm = length(normal);
    if (!(norm > 0)) return true;
    return std::all_of(triangles.begin(), triangles.end(), [&](const Triangle& t) {
        return std::all_of(t.begin(), t.end(), [&](std::uint32_t v) {
            return std::fabs(dot(soup.vertices[v] - on_plane, normal)) <= kFlat * size * norm;
        });
    });
}

// Turns the longest edge of triangles that have no height over it: their middle corner then splits the neighbour. The
// surface does not change, and the triangle without a normal is gone.
std::size_t remove_flat_triangles(Surface& surface, std::size_t& left) {
    std::size_t removed = 0;
    for (int pass = 0; pass < 8; ++pass) {
        std::vector<std::pair<std::uint32_t, std::size_t>> flat;  // triangle and its longest side
        for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
            std::array<Vec3d, 3> edge;
            for (int i = 0; i < 3; ++i)
                edge[static_cast<std::size_t>(i)] = surface.corner(t, (i + 1) % 3) - surface.corner(t, i);
            std::size_t longest = 0;
            for (std::size_t i = 1; i < 3; ++i) {
                if (dot(edge[i], edge[i]) > dot(edge[longest], edge[longest])) longest = i;
            }
            if (length(cross(edge[0], edge[1])) <= 1e-6 * dot(edge[longest], edge[longest]))
                flat.push_back({t, longest});
        }
        left = flat.size();
        if (flat.empty()) break;

        const Neighbours neighbours = find_neighbours(surface, "repair");
        const std::vector<HalfEdge> half_edges = sorted_half_edges(surface.triangles);
        const auto exists = [&](std::uint32_t a, std::uint32_t b) {
            const auto key = std::minmax(a, b);
            const auto at = std::lower_bound(
                half_edges.begin(), half_edges.end(), key,
                [](const HalfEdge& e, const auto& k) { return std::tie(e.low, e.high) < std::tie(k.first, k.second); });
            return at != half_edges.end() && at->low == key.first && at->high == key.second;
        };
        std::vector<char> touched(surface.triangles.size(), 0);
        std::set<std::pair<std::uint32_t, std::uint32_t>> made;
        std::size_t turned = 0;
        for (const auto& [t, side] : flat) {
            const std::uint32_t u = neighbours[t][side];
            if (touched[t] || touched[u]) continue;
            Triangle& mine = surface.triangles[t];
            Triangle& other = surface.triangles[u];
            const std::uint32_t a = mine[side], b = mine[(side + 1) % 3], c = mine[(side + 2) % 3];
            std::uint32_t d = a;
            for (const std::uint32_t v : other) {
                if (v != a && v != b) d = v;
            }
            if (d == a || d == c || exists(c, d) || !made.insert(std::minmax(c, d)).second) continue;
            mine = {a, d, c};
            other = {d, b, c};
            // The table of neighbours is old from here on for all around; they are left to the next pass.
            touched[t] = touched[u] = 1;
            for (const std::uint32_t n : neighbours[t]) touched[n] = 1;
            for (const std::uint32_t n : neighbours[u]) touched[n] = 1;
            ++turned;
        }
        removed += turned;
        if (turned == 0) break;
    }
    return removed;
}

}  // namespace

Repaired repair(const Surface& soup, const std::string& name) {
    for (const Triangle& t : soup.triangles) {
        for (const std::uint32_t v : t) {
            if (v >= soup.vertices.size()) throw BakeError(name + ": a triangle names a vertex that does not exist");
        }
    }
    if (soup.triangles.empty()) throw BakeError(name + ": has no triangles; export a scene with a mesh");
    const SurfaceProperties box = measure(soup);
    const Vec3d extent = box.high - box.low;
    const double size = std::max({extent.x, extent.y, extent.z});
    if (!(size > 0) || !std::isfinite(size))
        throw BakeError(name + ": all its vertices are one point, or not finite; export it again");

    Repaired result;
    Candidate best = close_surface(soup, size);
    if (best.triangles.empty() || is_planar(soup, best.triangles, size)) refuse_flat(name, "the shape", soup, soup);
    if (best.odd_edges != 0) refuse_open(name, soup, best.triangles, size);
    auto parts = std::make_unique<Shells>(soup.vertices, best.triangles);
    if (parts->unpaired()) {
        // Four at an edge close nothing off by themselves; two of them may be those of a wall inside.
        std::vector<Triangle> skin = without_inner_walls(soup.vertices, best.triangles);
        best.inner += best.triangles.size() - skin.size();
        best.triangles = std::move(skin);
        parts = std::make_unique<Shells>(soup.vertices, best.triangles);
    }
    Shells& shells = *parts;
    if (shells.unpaired()) refuse_crowded(name, soup, best.triangles, *shells.unpaired());
    note_closing(best, size, result.notes);
    if (const Triangle* t = shells.make_consistent()) refuse_one_sided(name, soup, *t);
    if (shells.turned())
        result.notes.push_back("turned " + count_of(shells.turned(), "triangle") +
                               " the same way round as their neighbours");
    for (std::uint32_t s = 0; s < shells.count(); ++s) {
        const SurfaceProperties p = shells.properties(s);
        const Vec3d e = p.high - p.low;
        if (2 * std::fabs(p.volume) <= kFlat * std::max({e.x, e.y, e.z}) * p.area) {
            refuse_flat(name, shells.count() == 1 ? std::string("the shape") : "the piece near " + place(p.low), soup,
                        shells.piece(s));
        }
    }
    if (const std::uint32_t inward = shells.turn_outward())
        result.notes.push_back("turned " + count_of(inward, "piece") + " that faced inward");
    if (const std::uint32_t inner = shells.remove_inner()) {
        result.notes.push_back("removed " + count_of(inner, "piece") +
                               " wholly inside another (water cannot reach it)");
    }
    result.shells = shells.count();
    result.surface = shells.surface();
    // Back to back between two pieces is a wall that went; back to back in the water is a sheet that matters.
    const std::vector<Triangle> sheet = reaching_outside(result.surface, soup.vertices, best.walls);
    if (!sheet.empty())
        refuse_flat(name, "the piece near " + place(soup.vertices[sheet[0][0]]), soup, {soup.vertices, sheet});

    std::size_t left = 0;
    const std::size_t flat = remove_flat_triangles(result.surface, left);
    if (flat) result.notes.push_back("turned an edge of " + count_of(flat, "triangle") + " without height");
    if (left) result.notes.push_back("left " + count_of(left, "triangle") + " without height");
    result.cuts = find_cuts(result.surface);
    note_cuts(result.cuts, result.notes);
    return result;
}

}  // namespace frm::bake
