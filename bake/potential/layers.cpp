#include "bake/potential/layers.h"

#include <cmath>

#include "bake/flow/threads.h"

namespace frm::bake {
namespace {

constexpr double four_pi = 4 * 3.14159265358979323846;

struct Node {
    double a, b, c, weight;  // barycentric; the weights sum to 1
};

// Strang & Fix 1973: exact to degree 2, and Radon's to degree 5.
constexpr Node three[] = {
    {2. / 3, 1. / 6, 1. / 6, 1. / 3}, {1. / 6, 2. / 3, 1. / 6, 1. / 3}, {1. / 6, 1. / 6, 2. / 3, 1. / 3}};
constexpr double r1 = 0.10128650732345633, r2 = 0.47014206410511505, w1 = 0.12593918054482717, w2 = 0.13239415278850616;
constexpr Node seven[] = {{1. / 3, 1. / 3, 1. / 3, 0.225}, {1 - 2 * r1, r1, r1, w1}, {r1, 1 - 2 * r1, r1, w1},
                          {r1, r1, 1 - 2 * r1, w1},        {1 - 2 * r2, r2, r2, w2}, {r2, 1 - 2 * r2, r2, w2},
                          {r2, r2, 1 - 2 * r2, w2}};

Vec3d at(const std::array<Vec3d, 3>& c, const Node& n) { return c[0] * n.a + c[1] * n.b + c[2] * n.c; }

// A point of the outer integral over a panel.
struct Sample {
    Vec3d x;
    double weight = 0;
    Modes push;  // times the weight
};

// Sums over the outer points for one inner panel.
struct Row {
    double source = 0;                            // of 1 / r over the pair at hand
    std::array<Modes, 3> dipole{};                // g_k over all outer panels, for each corner of the inner one
    std::array<std::array<double, 4>, 6> push{};  // g_k times the integrals of 1 / r and y / r

    void add(const Sample& s, double source_, const Vec3d& moment, const std::array<double, 3>& dipole_) {
        source += s.weight * source_;
        for (std::size_t k = 0; k < 6; ++k) {
            for (std::size_t i = 0; i < 3; ++i) dipole[i][k] += s.push[k] * dipole_[i];
            push[k][0] += s.push[k] * source_;
            push[k][1] += s.push[k] * moment.x;
            push[k][2] += s.push[k] * moment.y;
            push[k][3] += s.push[k] * moment.z;
        }
    }
};

class Assembly {
public:
    Assembly(const std::vector<Panel>& panels, const std::vector<char>& buried)
        : panels_(panels), buried_(buried), samples_(panels.size()) {
        for (std::size_t t = 0; t < panels.size(); ++t) {
            for (std::size_t q = 0; q < 3; ++q)
                samples_[t][q] = sample(t, at(panels[t].corner, three[q]), panels[t].area / 3);
        }
    }

    // All outer panels for the inner panel t; source[u] for u <= t.
    Row row(std::size_t t, double* source) const {
        Row sums;
        for (std::size_t u = 0; u < panels_.size(); ++u) {
            sums.source = 0;
            if (far(t, panels_[u].centre, panels_[u].radius)) {
                for (const Sample& s : samples_[u]) add_far(t, s, sums);
            } else {
                add_near(t, u, panels_[u].corner, panels_[u].area, panels_[u].radius, 4, sums);
            }
            if (u <= t) source[u] = sums.source;
        }
        return sums;
    }

private:
    Sample sample(std::size_t t, const Vec3d& x, double weight) const {
        Sample s{x, weight, push(panels_[t].normal, x)};
        const double share = !buried_.empty() && buried_[t] != 0 ? 0 : weight;
        for (double& v : s.push) v *= share;
        return s;
    }

    // With three points on each side the error is then below 3e-4 of the pair.
    bool far(std::size_t t, const Vec3d& centre, double radius) const {
        const Vec3d d = centre - panels_[t].centre;
        const double reach = 2.5 * (panels_[t].radius + radius);
        return dot(d, d) > reach * reach;
    }

    void add_far(std::size_t t, const Sample& s, Row& sums) const {
        const Panel& panel = panels_[t];
        const double height = dot(s.x - panel.corner[0], panel.normal);
        double source = 0, third[3];
        Vec3d moment;
        for (std::size_t q = 0; q < 3; ++q) {
            const Vec3d& y = samples_[t][q].x;
            const Vec3d d = s.x - y;
            const double squared = dot(d, d), inverse = samples_[t][q].weight / std::sqrt(squared);
            source += inverse;
            moment += y * inverse;
            third[q] = height * inverse / squared;
        }
        const double sum = (third[0] + third[1] + third[2]) / 6;  // point q is 2/3, 1/6, 1/6 of the corners
        sums.add(s, source, moment, {sum + 0.5 * third[0], sum + 0.5 * third[1], sum + 0.5 * third[2]});
    }

    // Closed form inside, seven points outside, on pieces small enough for the inner panel's field.
    void add_near(std::size_t t, std::size_t outer, const std::array<Vec3d, 3>& c, double area, double radius,
                  int depth, Row& sums) const {
        const Panel& inner = panels_[t];
        const Vec3d centre = (c[0] + c[1] + c[2]) / 3.0, d = centre - inner.centre;
        const double reach = 1.2 * (inner.radius + radius);
        if (depth > 0 && radius > 0.6 * inner.radius && dot(d, d) < reach * reach) {
            const Vec3d ab = (c[0] + c[1]) * 0.5, bc = (c[1] + c[2]) * 0.5, ca = (c[2] + c[0]) * 0.5;
            add_near(t, outer, {c[0], ab, ca}, area / 4, radius / 2, depth - 1, sums);
            add_near(t, outer, {ab, c[1], bc}, area / 4, radius / 2, depth - 1, sums);
            add_near(t, outer, {ca, bc, c[2]}, area / 4, radius / 2, depth - 1, sums);
            add_near(t, outer, {ab, bc, ca}, area / 4, radius / 2, depth - 1, sums);
            return;
        }
        for (const Node& node : seven) {
            const Sample s = sample(outer, at(c, node), node.weight * area);
            const PanelField f = panel_field(inner, s.x);
            sums.add(s, f.source, f.moment + s.x * f.source, f.dipole);
        }
    }

    const std::vector<Panel>& panels_;
    const std::vector<char>& buried_;
    std::vector<std::array<Sample, 3>> samples_;
};

}  // namespace

Layers make_layers(const Surface& surface, const std::vector<char>& buried, int threads) {
    Layers result;
    const std::size_t count = surface.triangles.size(), vertices = surface.vertices.size();
    for (std::size_t t = 0; t < count; ++t)
        result.panels.emplace_back(surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2));
    const std::vector<Panel>& panels = result.panels;

    std::vector<double> source(count * (count + 1) / 2);  // of 1 / r between panels
    std::vector<Row> rows(count);
    const Assembly assembly(panels, buried);
    const auto n = static_cast<std::ptrdiff_t>(count);
#pragma omp parallel for num_threads(flow::thread_count(threads)) schedule(dynamic, 8)
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        const auto t = static_cast<std::size_t>(i);
        rows[t] = assembly.row(t, source.data() + t * (t + 1) / 2);
    }

    result.load.assign(vertices, Modes{});
    result.direct.fill(0);
    for (std::size_t t = 0; t < count; ++t) {
        const Panel& p = panels[t];
        const bool wet = buried.empty() || buried[t] == 0;
        for (std::size_t i = 0; i < 3; ++i) {
            Modes& load = result.load[surface.triangles[t][i]];
            // Half of <f_i, g_k>: g is linear on the panel.
            Vec3d x = p.centre + (p.corner[i] - p.centre) * 0.25;
            const Modes g = push(p.normal, x);
            for (std::size_t k = 0; k < 6; ++k)
                load[k] += (wet ? p.area / 6 * g[k] : 0) + rows[t].dipole[i][k] / four_pi;
        }
        for (std::size_t k = 0; k < 6 && wet; ++k) {
            const auto& s = rows[t].push[k];
            const Vec3d turn = cross(Vec3d(s[1], s[2], s[3]), p.normal);
            const double field[6] = {p.normal.x * s[0], p.normal.y * s[0], p.normal.z * s[0], turn.x, turn.y, turn.z};
            for (std::size_t l = 0; l < 6; ++l) result.direct[6 * k + l] += field[l] / four_pi;
        }
    }

    // By Maue's formula (1949) the double layer's normal derivative is the single layer between surface curls: constant
    // vectors on the panels, as of vortex sheets. So positive by construction, and no integral is worse than 1 / r.
    std::vector<std::vector<std::array<std::uint32_t, 2>>> fans(vertices);  // triangle and corner at each vertex
    std::vector<std::array<Vec3d, 3>> curl(count);
    for (std::uint32_t t = 0; t < count; ++t) {
        for (std::uint32_t i = 0; i < 3; ++i) {
            fans[surface.triangles[t][i]].push_back({t, i});
            curl[t][i] = cross(panels[t].normal, panels[t].gradient[i]);
        }
    }
    result.stiffness.assign(vertices * (vertices + 1) / 2, 0.0);
    const auto m = static_cast<std::ptrdiff_t>(vertices);
#pragma omp parallel for num_threads(flow::thread_count(threads)) schedule(dynamic, 8)
    for (std::ptrdiff_t v = 0; v < m; ++v) {
        const auto i = static_cast<std::size_t>(v);
        double* const row = result.stiffness.data() + i * (i + 1) / 2;
        for (std::size_t u = 0; u < count; ++u) {
            Vec3d sum;
            for (const auto& [t, c] : fans[i]) {
                const double s = t >= u ? source[std::size_t{t} * (t + 1) / 2 + u] : source[u * (u + 1) / 2 + t];
                sum += curl[t][c] * s;
            }
            sum = sum / four_pi;
            for (std::size_t j = 0; j < 3; ++j) {
                const std::uint32_t w = surface.triangles[u][j];
                if (w <= i) row[w] += dot(sum, curl[u][j]);
            }
        }
    }
    return result;
}

}  // namespace frm::bake
