#include "bake/potential/refine.h"

#include <queue>
#include <utility>

#include "bake/error.h"
#include "bake/mesh/adjacency.h"

namespace frm::bake {
namespace {

class Halving {
public:
    Halving(const Surface& surface, const std::vector<double>& error)
        : surface_(surface), neighbours_(find_neighbours(surface, "refine")), error_(error) {
        for (std::uint32_t t = 0; t < error_.size(); ++t) offer(t);
    }

    void run(std::size_t most_triangles) {
        while (!waiting_.empty() && surface_.triangles.size() + 2 <= most_triangles) {
            const Waiting next = waiting_.top();
            if (next.error != error_[next.triangle]) {  // halved meanwhile
                waiting_.pop();
                continue;
            }
            // The neighbour across the longest side may have a longer one of its own, and so on; the last is halved.
            std::uint32_t t = next.triangle, side = longest(t);
            for (;;) {
                const std::uint32_t u = neighbours_[t][side], other = longest(u);
                if (!(squared(u, other) > squared(t, side))) break;
                t = u;
                side = other;
            }
            halve(t, side);
        }
    }

    Surface take() { return std::move(surface_); }

private:
    struct Waiting {
        double error = 0;
        std::uint32_t triangle = 0;

        bool operator<(const Waiting& other) const {
            return error != other.error ? error < other.error : triangle > other.triangle;
        }
    };

    void offer(std::uint32_t t) { waiting_.push({error_[t], t}); }

    double squared(std::uint32_t t, std::uint32_t side) const {
        const Vec3d d =
            surface_.vertices[surface_.triangles[t][(side + 1) % 3]] - surface_.vertices[surface_.triangles[t][side]];
        return dot(d, d);
    }

    std::uint32_t longest(std::uint32_t t) const {
        std::uint32_t side = 0;
        for (std::uint32_t i = 1; i < 3; ++i) {
            if (squared(t, i) > squared(t, side)) side = i;
        }
        return side;
    }

    std::uint32_t side_from(std::uint32_t t, std::uint32_t vertex) const {
        const Triangle& corners = surface_.triangles[t];
        return corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2;
    }

    // t keeps the part before the middle of its side i, `added` gets the part after it.
    void cut(std::uint32_t t, std::uint32_t i, std::uint32_t middle, std::uint32_t added) {
        const Triangle old = surface_.triangles[t];
        const std::array<std::uint32_t, 3> across = neighbours_[t];
        const std::uint32_t b = old[(i + 1) % 3], c = old[(i + 2) % 3], beyond = across[(i + 1) % 3];
        neighbours_[beyond][side_from(beyond, c)] = added;
        surface_.triangles[t] = {old[i], middle, c};
        surface_.triangles[added] = {middle, b, c};
        neighbours_[t] = {across[i], added, across[(i + 2) % 3]};
        neighbours_[added] = {across[i], beyond, t};
        error_[t] *= 0.25;
        error_[added] = error_[t];
    }

    void halve(std::uint32_t t, std::uint32_t side) {
        const std::uint32_t u = neighbours_[t][side];
        const Vec3d from = surface_.vertices[surface_.triangles[t][side]];
        const std::uint32_t to = surface_.triangles[t][(side + 1) % 3];
        const auto middle = static_cast<std::uint32_t>(surface_.vertices.size());
        surface_.vertices.push_back((from + surface_.vertices[to]) * 0.5);
        const auto t_added = static_cast<std::uint32_t>(surface_.triangles.size()), u_added = t_added + 1;
        surface_.triangles.resize(u_added + 1);
        neighbours_.resize(u_added + 1);
        error_.resize(u_added + 1);
        cut(t, side, middle, t_added);
        cut(u, side_from(u, to), middle, u_added);
        neighbours_[t][0] = u_added;
        neighbours_[u_added][0] = t;
        neighbours_[u][0] = t_added;
        neighbours_[t_added][0] = u;
        for (const std::uint32_t changed : {t, t_added, u, u_added}) offer(changed);
    }

    Surface surface_;
    Neighbours neighbours_;
    std::vector<double> error_;
    std::priority_queue<Waiting> waiting_;
};

}  // namespace

Surface refine(const Surface& surface, const std::vector<double>& error, std::size_t most_triangles) {
    if (error.size() != surface.triangles.size()) throw BakeError("refine: one error for each triangle is needed");
    Halving halving(surface, error);
    halving.run(most_triangles);
    return halving.take();
}

}  // namespace frm::bake
