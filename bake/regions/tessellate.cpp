#include "bake/regions/tessellate.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "bake/mesh/adjacency.h"

namespace frm::bake {

namespace {

// A side waiting to be halved. It is out of date when its triangle has been cut meanwhile and no longer has these two
// corners.
struct Candidate {
    double squared_length = 0;
    std::uint32_t from = 0, to = 0;
    std::uint32_t triangle = 0, side = 0;

    // Longest first; between equal ones the oldest vertices, so that the order does not depend on the queue.
    bool operator<(const Candidate& other) const {
        if (squared_length != other.squared_length) return squared_length < other.squared_length;
        if (from != other.from) return from > other.from;
        if (to != other.to) return to > other.to;
        return triangle > other.triangle;
    }
};

class Bisection {
public:
    Bisection(const Surface& surface, double longest_edge)
        : surface_(surface), neighbours_(find_neighbours(surface, "tessellate")), limit_(longest_edge * longest_edge) {
        source_.resize(surface.triangles.size());
        for (std::uint32_t t = 0; t < source_.size(); ++t) {
            source_[t] = t;
            for (std::uint32_t i = 0; i < 3; ++i) offer(t, i);
        }
    }

    void run(std::size_t most_triangles) {
        while (!waiting_.empty()) {
            const Candidate c = waiting_.top();
            const Triangle& t = surface_.triangles[c.triangle];
            if (t[c.side] != c.from || t[(c.side + 1) % 3] != c.to) {
                waiting_.pop();
                continue;
            }
            if (surface_.triangles.size() + 2 > most_triangles) return;
            waiting_.pop();
            halve(c.triangle, c.side);
        }
    }

    // Triangles cut from one come one after the other: they are near each other in memory as in space.
    Tessellation take() {
        Tessellation result;
        std::vector<std::uint32_t> order(source_.size());
        for (std::uint32_t t = 0; t < order.size(); ++t) order[t] = t;
        std::stable_sort(order.begin(), order.end(),
                         [&](std::uint32_t a, std::uint32_t b) { return source_[a] < source_[b]; });
        double longest = 0;
        for (const std::uint32_t t : order) {
            result.surface.triangles.push_back(surface_.triangles[t]);
            result.source.push_back(source_[t]);
            for (std::uint32_t i = 0; i < 3; ++i) longest = std::max(longest, squared_length(t, i));
        }
        result.surface.vertices = std::move(surface_.vertices);
        result.longest_edge = std::sqrt(longest);
        return result;
    }

private:
    double squared_length(std::uint32_t t, std::uint32_t i) const {
        const Vec3d d =
            surface_.vertices[surface_.triangles[t][(i + 1) % 3]] - surface_.vertices[surface_.triangles[t][i]];
        return dot(d, d);
    }

    void offer(std::uint32_t t, std::uint32_t i) {
        const double squared = squared_length(t, i);
        if (squared > limit_)
            waiting_.push({squared, surface_.triangles[t][i], surface_.triangles[t][(i + 1) % 3], t, i});
    }

    void relink(std::uint32_t t, std::uint32_t before, std::uint32_t after, std::uint32_t from) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            if (neighbours_[t][i] == before && surface_.triangles[t][(i + 1) % 3] == from) neighbours_[t][i] = after;
        }
    }

    std::uint32_t side_from(std::uint32_t t, std::uint32_t vertex) const {
        const Triangle& corners = surface_.triangles[t];
        return corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
    }

    // Cuts t from the middle of side i to the opposite corner: t keeps the part before the middle, the new triangle is
    // after it.
    void cut(std::uint32_t t, std::uint32_t i, std::uint32_t middle, std::uint32_t added) {
        const Triangle old = surface_.triangles[t];
        const std::array<std::uint32_t, 3> across = neighbours_[t];
        const std::uint32_t a = old[i], b = old[(i + 1) % 3], c = old[(i + 2) % 3];
        relink(across[(i + 1) % 3], t, added, b);
        surface_.triangles[t] = {a, middle, c};
        surface_.triangles[added] = {middle, b, c};
        neighbours_[t] = {across[i], added, across[(i + 2) % 3]};
        neighbours_[added] = {across[i], across[(i + 1) % 3], t};
        source_[added] = source_[t];
    }

    void halve(std::uint32_t t, std::uint32_t side) {
        const std::uint32_t u = neighbours_[t][side];
        const std::uint32_t from = surface_.triangles[t][side], to = surface_.triangles[t][(side + 1) % 3];
        const auto middle = static_cast<std::uint32_t>(surface_.vertices.size());
        surface_.vertices.push_back((surface_.vertices[from] + surface_.vertices[to]) * 0.5);

        const auto t_added = static_cast<std::uint32_t>(surface_.triangles.size());
        const std::uint32_t u_added = t_added + 1;
        surface_.triangles.resize(u_added + 1);
        neighbours_.resize(u_added + 1);
        source_.resize(u_added + 1);
        cut(t, side, middle, t_added);
        cut(u, side_from(u, to), middle, u_added);
        // Each half of the edge now has one part of t and one of u.
        neighbours_[t][0] = u_added;
        neighbours_[u_added][0] = t;
        neighbours_[u][0] = t_added;
        neighbours_[t_added][0] = u;
        for (const std::uint32_t changed : {t, t_added, u, u_added}) {
            for (std::uint32_t i = 0; i < 3; ++i) offer(changed, i);
        }
    }

    Surface surface_;
    Neighbours neighbours_;
    std::vector<std::uint32_t> source_;
    std::priority_queue<Candidate> waiting_;
    double limit_;
};

}  // namespace

Tessellation tessellate(const Surface& surface, double longest_edge, std::uint32_t most_triangles) {
    if (!(longest_edge > 0)) throw BakeError("tessellate: the longest edge must be more than 0 m");
    Bisection bisection(surface, longest_edge);
    bisection.run(most_triangles);
    return bisection.take();
}

Surface sample_triangles(const Surface& surface, std::uint32_t most_triangles) {
    const SurfaceProperties shape = measure(surface);
    return tessellate(surface, length(shape.high - shape.low) / 24, most_triangles).surface;
}

}  // namespace frm::bake
