#include "bake/mesh/refusals.h"

#include <algorithm>
#include <cstdio>
#include <numeric>

#include "bake/mesh/holes.h"

namespace frm::bake {

namespace {

// Rims that enclose more than this share of the area of the open pieces are those of sheets (a sail's is near 1, half a sphere's
// 0.5), not of a vessel (a box without a lid: 0.2).
constexpr double kSheet = 0.4;

constexpr const char* kThicken = "give it its real thickness (Blender: Solidify modifier, apply it) and export again";

std::array<Vec3d, 2> ends(const Surface& soup, const HalfEdge& e) {
    return {soup.vertices[e.low], soup.vertices[e.high]};
}

Vec3d middle(const std::array<Vec3d, 2>& edge) { return (edge[0] + edge[1]) * 0.5; }

// "2 holes, the larger 300 mm across", or nothing where edges of one triangle form no closed chain.
std::string describe(const Surface& soup, const std::vector<std::vector<std::uint32_t>>& rims) {
    if (rims.empty()) return "";
    double widest = 0;
    for (const auto& rim : rims) widest = std::max(widest, rim_extent(soup.vertices, rim));
    return " around " + count_of(rims.size(), "hole") + (rims.size() > 1 ? ", the largest " : ", ") +
           length_text(widest) + " across";
}

// Area of the pieces (all that hangs together by edges) that have an edge of one triangle.
double open_area(const Surface& soup, const std::vector<Triangle>& triangles, const std::vector<HalfEdge>& half_edges) {
    std::vector<std::uint32_t> leader(triangles.size());
    std::iota(leader.begin(), leader.end(), 0u);
    const auto find = [&](std::uint32_t t) {
        while (leader[t] != t) t = leader[t] = leader[leader[t]];
        return t;
    };
    for (std::size_t i = 0; i + 1 < half_edges.size(); ++i) {
        const HalfEdge &a = half_edges[i], &b = half_edges[i + 1];
        if (a.low == b.low && a.high == b.high) leader[find(b.triangle)] = find(a.triangle);
    }
    std::vector<char> open(triangles.size(), 0);
    for (std::size_t i = 0, j = 0; i < half_edges.size(); i = j) {
        j = edge_end(half_edges, i);
        if (j - i == 1) open[find(half_edges[i].triangle)] = 1;
    }
    double area = 0;
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
        if (open[find(t)])
            area += 0.5 * length(cross(soup.vertices[triangles[t][1]] - soup.vertices[triangles[t][0]],
                                       soup.vertices[triangles[t][2]] - soup.vertices[triangles[t][0]]));
    }
    return area;
}

}  // namespace

std::string count_of(std::size_t n, const char* thing) { return std::to_string(n) + " " + thing + (n == 1 ? "" : "s"); }

std::string length_text(double metres) {
    char text[32];
    std::snprintf(text, sizeof text, metres < 1 ? "%.3g mm" : "%.3g m", metres < 1 ? metres * 1000 : metres);
    return text;
}

std::string place(const Vec3d& p) {
    char text[96];
    std::snprintf(text, sizeof text, "(%.4g, %.4g, %.4g) m", p.x, p.y, p.z);
    return text;
}

void refuse_flat(const std::string& name, const std::string& what, const Surface& soup, const Surface& sheet) {
    Marks marks;
    for (std::size_t t = 0; t < sheet.triangles.size(); ++t)
        marks.triangles.push_back({sheet.corner(t, 0), sheet.corner(t, 1), sheet.corner(t, 2)});
    throw MeshError(name + ": " + what +
                        " is a flat sheet without thickness, so water has no inside to be kept out of; " + kThicken,
                    soup, std::move(marks));
}

void refuse_open(const std::string& name, const Surface& soup, const std::vector<Triangle>& triangles, double size) {
    const std::vector<HalfEdge> half_edges = sorted_half_edges(triangles);
    Marks boundary, shared;
    std::size_t first_shared_by = 0;
    for (std::size_t i = 0, j = 0; i < half_edges.size(); i = j) {
        j = edge_end(half_edges, i);
        if (j - i == 1) boundary.edges.push_back(ends(soup, half_edges[i]));
        if (j - i > 2 && (j - i) % 2 == 1) {
            shared.edges.push_back(ends(soup, half_edges[i]));
            if (first_shared_by == 0) first_shared_by = j - i;
        }
    }
    if (boundary.edges.empty()) {
        const std::string text = name + ": " + count_of(shared.edges.size(), "edge") +
                                 " shared by more than two triangles, the first at " + place(middle(shared.edges[0])) +
                                 " by " + std::to_string(first_shared_by) +
                                 "; remove inner walls and loose faces there (Blender: Select > All by Trait > Non "
                                 "Manifold) and export again";
        throw MeshError(text, soup, std::move(shared));
    }

    const std::vector<std::vector<std::uint32_t>> rims = find_rims(triangles);
    const std::string where = count_of(boundary.edges.size(), "boundary edge") + describe(soup, rims) +
                              ", the first at " + place(middle(boundary.edges[0]));
    double enclosed = 0;
    for (const auto& rim : rims) enclosed += 0.5 * length(rim_area(soup.vertices, rim));
    std::string text;
    if (enclosed > kSheet * open_area(soup, triangles, half_edges)) {
        text = name + ": is an open sheet without thickness (a sail, a leaf, one side of a plate): " + where +
               "; water has no inside to be kept out of: " + kThicken;
    } else {
        char share[16];
        std::snprintf(share, sizeof share, "%g %%", 100 * kHoleArea);
        text =
            name + ": the surface is open: " + where + "; frm closes holes only under " +
            length_text(kHoleExtent * size) + " and " + share +
            " of the surface: close the others (Blender: select all, Mesh > Clean Up > Fill Holes; a shape of sheets "
            "needs a Solidify modifier) and export again";
    }
    boundary.edges.insert(boundary.edges.end(), shared.edges.begin(), shared.edges.end());
    throw MeshError(text, soup, std::move(boundary));
}

void refuse_crowded(const std::string& name, const Surface& soup, const std::vector<Triangle>& triangles,
                    const HalfEdge& first) {
    const std::vector<HalfEdge> half_edges = sorted_half_edges(triangles);
    Marks marks;
    for (std::size_t i = 0, j = 0; i < half_edges.size(); i = j) {
        j = edge_end(half_edges, i);
        if (j - i > 2) marks.edges.push_back(ends(soup, half_edges[i]));
    }
    throw MeshError(
        name + ": an edge at " + place(middle(ends(soup, first))) +
            " is shared by four triangles or more of one piece; separate what touches there and export again",
        soup, std::move(marks));
}

void refuse_one_sided(const std::string& name, const Surface& soup, const Triangle& triangle) {
    Marks marks;
    marks.triangles.push_back({soup.vertices[triangle[0]], soup.vertices[triangle[1]], soup.vertices[triangle[2]]});
    throw MeshError(name + ": the surface has only one side (as a Moebius strip or Klein bottle) near " +
                        place(soup.vertices[triangle[0]]) + "; model it with an inside and an outside",
                    soup, std::move(marks));
}

}  // namespace frm::bake
