#include "bake/potential/added_mass.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "bake/error.h"
#include "bake/flow/threads.h"
#include "bake/math/cholesky.h"
#include "bake/mesh/adjacency.h"
#include "bake/mesh/shells.h"
#include "bake/potential/coarsen.h"
#include "bake/potential/layers.h"
#include "bake/potential/refine.h"
#include "bake/regions/tessellate.h"

namespace frm::bake {
namespace {

using Matrix = std::array<double, 36>;

constexpr double growth = 1.6;  // of the number of triangles from mesh to mesh

struct Solution {
    Matrix mass{};              // for density 1
    std::vector<Modes> dipole;  // at each vertex: minus the potential of the water there
};

// Which triangles lie inside another piece: a little outside their middles the surface winds around something.
std::vector<char> find_buried(const Surface& surface, int threads) {
    std::vector<char> buried(surface.triangles.size());
    const auto n = static_cast<std::ptrdiff_t>(buried.size());
#pragma omp parallel for num_threads(flow::thread_count(threads)) schedule(dynamic, 8)
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        const auto t = static_cast<std::size_t>(i);
        const Panel p(surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2));
        buried[t] = winding(surface, p.centre + p.normal * 1e-5) > 0.5;
    }
    return buried;
}

double buried_share(const Surface& surface, int threads) {
    const std::vector<char> buried = find_buried(surface, threads);
    double inside = 0, all = 0;
    for (std::size_t t = 0; t < buried.size(); ++t) {
        const double area = Panel(surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2)).area;
        if (buried[t] != 0) inside += area;
        all += area;
    }
    return inside / all;
}

// With N the operator from normal velocity to (minus) the outer potential, the fluid's energy is <g, N g> / 2, and
//     N = V + (1/2 + K) W^-1 (1/2 + K')
// (the symmetric form of Calderon's projector; W the hypersingular operator). In any space of potentials the second
// term is a positive form that grows with the space to the exact one: the mass is positive and, but for quadrature,
// never too large.
Solution solve(const Surface& surface, bool overlaps, int threads) {
    Layers layers = make_layers(surface, overlaps ? find_buried(surface, threads) : std::vector<char>(), threads);
    const std::size_t n = surface.vertices.size();

    // A constant on a shell does nothing: W cannot see it. Its square, weighted by area, makes W definite and changes
    // no answer, because the load has no constant part.
    std::vector<std::uint32_t> shell_of;
    const std::uint32_t shells = find_shells(find_neighbours(surface, "added mass"), shell_of);
    std::vector<double> weight(n), total(shells);
    std::vector<std::uint32_t> vertex_shell(n);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        total[shell_of[t]] += layers.panels[t].area;
        for (const std::uint32_t v : surface.triangles[t]) {
            weight[v] += layers.panels[t].area / 3;
            vertex_shell[v] = shell_of[t];
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        const double area = total[vertex_shell[i]], scale = weight[i] / (area * std::sqrt(area));
        for (std::size_t j = 0; j <= i; ++j) {
            if (vertex_shell[i] == vertex_shell[j]) layers.stiffness[i * (i + 1) / 2 + j] += scale * weight[j];
        }
    }

    const Cholesky factor(std::move(layers.stiffness), n, threads);
    Solution result;
    result.mass = layers.direct;
    result.dipole.resize(n);
    std::vector<double> x(n);
    for (std::size_t k = 0; k < 6; ++k) {
        for (std::size_t i = 0; i < n; ++i) x[i] = layers.load[i][k];
        factor.solve(x.data());
        for (std::size_t i = 0; i < n; ++i) {
            result.dipole[i][k] = x[i];
            for (std::size_t l = 0; l < 6; ++l) result.mass[6 * k + l] += x[i] * layers.load[i][l];
        }
    }
    for (std::size_t k = 0; k < 6; ++k) {
        for (std::size_t l = 0; l < k; ++l)
            result.mass[6 * k + l] = result.mass[6 * l + k] = 0.5 * (result.mass[6 * k + l] + result.mass[6 * l + k]);
    }
    return result;
}

// What a diagonal entry's error is compared with (see AddedMass::error).
Modes scales(const Matrix& mass, double squared_radius) {
    Modes scale{};
    double force = 0, torque = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        force = std::max(force, mass[7 * k]);
        torque = std::max(torque, mass[7 * (k + 3)]);
    }
    torque = std::max(torque, force * squared_radius);
    for (std::size_t k = 0; k < 6; ++k) scale[k] = std::max(mass[7 * k], 0.02 * (k < 3 ? force : torque));
    return scale;
}

// How much the potential's slope jumps at the sides of each triangle: where it does, straight pieces follow it badly.
std::vector<double> local_errors(const Surface& surface, const Solution& solution, const Modes& scale) {
    const std::size_t count = surface.triangles.size();
    const Neighbours neighbours = find_neighbours(surface, "added mass");
    std::vector<std::array<Modes, 3>> slope(count);  // across each side
    std::vector<Panel> panels;
    for (std::size_t t = 0; t < count; ++t) {
        panels.emplace_back(surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2));
        for (std::size_t side = 0; side < 3; ++side) {
            for (std::size_t k = 0; k < 6; ++k) {
                double sum = 0;
                for (std::size_t i = 0; i < 3; ++i)
                    sum += dot(panels[t].gradient[i], panels[t].outward[side]) *
                           solution.dipole[surface.triangles[t][i]][k];
                slope[t][side][k] = sum;
            }
        }
    }
    std::vector<double> error(count);
    for (std::size_t t = 0; t < count; ++t) {
        const double longest = std::max({panels[t].length[0], panels[t].length[1], panels[t].length[2]});
        for (std::size_t side = 0; side < 3; ++side) {
            const std::uint32_t u = neighbours[t][side], from = surface.triangles[t][(side + 1) % 3];
            const std::size_t other = surface.triangles[u][0] == from ? 0 : surface.triangles[u][1] == from ? 1 : 2;
            for (std::size_t k = 0; k < 6; ++k) {
                const double jump = slope[t][side][k] + slope[u][other][k];
                error[t] += jump * jump / scale[k] * panels[t].area * longest;
            }
        }
    }
    return error;
}

struct Frame {
    std::array<Vec3d, 3> axes{Vec3d(1, 0, 0), Vec3d(0, 1, 0), Vec3d(0, 0, 1)};
    double squared_radius = 0;  // of gyration of the surface
};

// The principal axes of the surface about the origin, by Jacobi's rotations. Errors are looked at, and entries
// extrapolated, one axis at a time: along its own axes a plate has a large and a small one, in between large ones only,
// of which the small one is a poor difference.
Frame principal_frame(const Surface& surface) {
    double m[3][3] = {}, area = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Panel p(surface.corner(t, 0), surface.corner(t, 1), surface.corner(t, 2));
        // Exact for squares: a twelfth of the corners' and three quarters of the middle's.
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                double sum = 9 * p.centre[i] * p.centre[j];
                for (const Vec3d& c : p.corner) sum += c[i] * c[j];
                m[i][j] += p.area * sum / 12;
            }
        }
        area += p.area;
    }
    Frame frame;
    const double trace = m[0][0] + m[1][1] + m[2][2];
    frame.squared_radius = trace / area;
    for (int sweep = 0; sweep < 20; ++sweep) {
        for (int p = 0; p < 2; ++p) {
            for (int q = p + 1; q < 3; ++q) {
                if (std::abs(m[p][q]) < 1e-9 * trace) continue;  // a body along the axes stays as it is
                const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
                const double t = (theta < 0 ? -1 : 1) / (std::abs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                for (int k = 0; k < 3; ++k) {
                    const double a = m[k][p], b = m[k][q];
                    m[k][p] = c * a - s * b;
                    m[k][q] = s * a + c * b;
                }
                for (int k = 0; k < 3; ++k) {
                    const double a = m[p][k], b = m[q][k];
                    m[p][k] = c * a - s * b;
                    m[q][k] = s * a + c * b;
                }
                Vec3d& first = frame.axes[static_cast<std::size_t>(p)];
                Vec3d& second = frame.axes[static_cast<std::size_t>(q)];
                const Vec3d before = first;
                first = before * c - second * s;
                second = before * s + second * c;
            }
        }
    }
    return frame;
}

// The mass along the axes of the mesh from that along a frame's.
Matrix along_mesh(const Matrix& mass, const Frame& frame) {
    const auto axis = [&](std::size_t i, std::size_t k) {
        return i / 3 == k / 3 ? frame.axes[k % 3][static_cast<int>(i % 3)] : 0;
    };
    Matrix result{};
    for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = 0;
            for (std::size_t k = 0; k < 6; ++k)
                for (std::size_t l = 0; l < 6; ++l) sum += axis(i, k) * mass[6 * k + l] * axis(j, l);
            result[6 * i + j] = result[6 * j + i] = sum;
        }
    }
    return result;
}

// Mass about the origin from the mass about `centre`, and from lengths in units of `size` to metres: with J the motion
// of the centre by that of the origin, J^T M J.
Matrix about_origin(const Matrix& mass, const Vec3d& centre, double size, double density) {
    const double c[3][3] = {{0, centre.z, -centre.y}, {-centre.z, 0, centre.x}, {centre.y, -centre.x, 0}};
    double j[6][6] = {};
    for (std::size_t i = 0; i < 6; ++i) j[i][i] = 1;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t k = 0; k < 3; ++k) j[i][k + 3] = c[i][k];
    const double unit[6] = {1, 1, 1, size, size, size};
    const double scale = density * size * size * size;
    Matrix result{};
    for (std::size_t a = 0; a < 6; ++a) {
        for (std::size_t b = 0; b <= a; ++b) {
            double sum = 0;
            for (std::size_t k = 0; k < 6; ++k)
                for (std::size_t l = 0; l < 6; ++l) sum += j[k][a] * j[l][b] * (mass[6 * k + l] * unit[k] * unit[l]);
            result[6 * a + b] = result[6 * b + a] = scale * sum;
        }
    }
    return result;
}

// The limit of three numbers that grow ever more slowly, as a geometric series (Aitken). Grading towards the edges
// makes an error of one over the number of triangles (von Petersdorff & Stephan 1990 for edges): a series that
// shrinks more slowly than that from mesh to mesh, as coarse meshes' do, is not trusted further.
double extrapolated(double first, double second, double third) {
    const double step = third - second, before = second - first;
    if (!(step > 0) || !(before > 0)) return third;
    const double ratio = std::min(step / before, 1 / growth);
    return third + step * ratio / (1 - ratio);
}

std::size_t shrunk(std::size_t triangles) { return static_cast<std::size_t>(static_cast<double>(triangles) / growth); }

// Longest sides halved until there are about so many triangles.
Surface filled(const Surface& surface, std::size_t triangles) {
    if (surface.triangles.size() + 2 > triangles) return surface;
    return tessellate(surface, 1e-9, static_cast<std::uint32_t>(triangles)).surface;
}

// By rounding, the least eigenvalue of a semidefinite matrix may be a little below 0. Its diagonal then grows by 1e-15
// of itself, or ten times that and so on, until elimination finds only positive pivots.
void make_definite(Matrix& mass) {
    const Matrix given = mass;
    for (double lift = 1e-15; lift < 1e-3; lift *= 10) {
        Matrix rest = mass;
        bool positive = true;
        for (std::size_t k = 0; k < 6 && positive; ++k) {
            positive = rest[7 * k] > 1e-15 * mass[7 * k];
            for (std::size_t i = k + 1; i < 6 && positive; ++i) {
                for (std::size_t j = k + 1; j < 6; ++j)
                    rest[6 * i + j] -= rest[6 * i + k] * rest[6 * k + j] / rest[7 * k];
            }
        }
        if (positive) return;
        for (std::size_t k = 0; k < 6; ++k) mass[7 * k] = given[7 * k] * (1 + lift);
    }
}

}  // namespace

AddedMass added_mass(const Surface& given, const AddedMassSettings& settings) {
    if (!(settings.density > 0) || !std::isfinite(settings.density))
        throw BakeError("added mass: the density must be above 0 kg/m^3");
    if (settings.most_triangles < 200 || settings.most_triangles > 20000)
        throw BakeError("added mass: the finest mesh must have 200 to 20000 triangles");
    const SurfaceProperties properties = measure(given);
    const double size = std::sqrt(properties.area);
    if (!(size > 0)) throw BakeError("added mass: the surface has no area");

    // In lengths of one, about the centroid and along the principal axes.
    Surface surface = given;
    for (Vec3d& v : surface.vertices) v = (v - properties.centroid) / size;
    const Frame frame = principal_frame(surface);
    for (Vec3d& v : surface.vertices) v = {dot(v, frame.axes[0]), dot(v, frame.axes[1]), dot(v, frame.axes[2])};
    const std::size_t finest = settings.most_triangles, first = shrunk(shrunk(finest));
    const Coarse coarse = coarsen(surface, first);
    if (coarse.surface.triangles.size() > finest * 4 / 5)
        throw BakeError("added mass: the surface has too many pieces: " +
                        std::to_string(coarse.surface.triangles.size()) + " triangles are left after coarsening");
    AddedMass result;
    result.buried = buried_share(filled(coarse.surface, first), settings.threads);
    const bool overlaps = result.buried > 0;
    Solution half;
    if (coarse.changed) half = solve(filled(coarsen(surface, first / 2).surface, first), overlaps, settings.threads);
    surface = filled(coarse.surface, first);

    // Three meshes, each inside the next.
    Solution solution[3];
    for (int level = 0; level < 3; ++level) {
        if (level > 0) {
            const Solution& last = solution[level - 1];
            surface = refine(surface, local_errors(surface, last, scales(last.mass, frame.squared_radius)),
                             level == 1 ? shrunk(finest) : finest);
        }
        solution[level] = solve(surface, overlaps, settings.threads);
    }

    result.triangles = surface.triangles.size();
    Matrix mass = solution[2].mass;
    const Modes scale = scales(mass, frame.squared_radius);
    Modes stretch;
    for (std::size_t k = 0; k < 6; ++k) {
        const double limit = extrapolated(solution[0].mass[7 * k], solution[1].mass[7 * k], mass[7 * k]);
        double error = (limit - mass[7 * k]) / scale[k];
        // What halving the number of triangles of the shape did is more than what halving it before did.
        if (coarse.changed) error += std::abs(half.mass[7 * k] - solution[0].mass[7 * k]) / scale[k];
        result.error = std::max(result.error, error);
        stretch[k] = mass[7 * k] > 0 ? std::sqrt(limit / mass[7 * k]) : 1;
    }
    // The same stretch of rows and columns keeps the matrix symmetric and positive.
    for (std::size_t k = 0; k < 6; ++k) {
        for (std::size_t l = 0; l < 6; ++l) mass[6 * k + l] *= stretch[k] * stretch[l];
    }
    result.matrix = about_origin(along_mesh(mass, frame), properties.centroid, size, settings.density);
    make_definite(result.matrix);
    return result;
}

}  // namespace frm::bake
