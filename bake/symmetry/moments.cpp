#include "bake/symmetry/moments.h"

#include <algorithm>
#include <cmath>

namespace frm::bake {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Weighted {
    double a, b, c, weight;  // barycentric
};

// Exact to the sixth degree (Dunavant, Int. J. Numer. Meth. Eng. 21, 1985: 12 points).
std::array<Weighted, 12> rule() {
    constexpr double w1 = 0.116786275726379, p1 = 0.501426509658179, q1 = 0.249286745170910;
    constexpr double w2 = 0.050844906370207, p2 = 0.873821971016996, q2 = 0.063089014491502;
    constexpr double w3 = 0.082851075618374, x = 0.053145049844817, y = 0.310352451033784, z = 0.636502499121399;
    return {{{p1, q1, q1, w1},
             {q1, p1, q1, w1},
             {q1, q1, p1, w1},
             {p2, q2, q2, w2},
             {q2, p2, q2, w2},
             {q2, q2, p2, w2},
             {x, y, z, w3},
             {x, z, y, w3},
             {y, x, z, w3},
             {y, z, x, w3},
             {z, x, y, w3},
             {z, y, x, w3}}};
}

template <typename Add>
void over_surface(const Surface& surface, const Vec3d& centre, Add add) {
    const auto points = rule();
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const Vec3d a = surface.corner(t, 0) - centre, b = surface.corner(t, 1) - centre,
                    c = surface.corner(t, 2) - centre;
        const double area = 0.5 * length(cross(b - a, c - a));
        for (const Weighted& p : points) add(a * p.a + b * p.b + c * p.c, area * p.weight);
    }
}

constexpr int kDegree = 6;

// f(d) as a polynomial: the coefficient of x^i y^j z^(6-i-j) in coefficient[i][j].
class SixthMoment {
public:
    SixthMoment(const Surface& surface, const Vec3d& centre) {
        constexpr double factorial[kDegree + 1] = {1, 1, 2, 6, 24, 120, 720};
        over_surface(surface, centre, [&](const Vec3d& p, double weight) {
            double x = weight;
            for (int i = 0; i <= kDegree; ++i, x *= p.x) {
                double xy = x;
                for (int j = 0; i + j <= kDegree; ++j, xy *= p.y) {
                    double xyz = xy;
                    for (int k = 0; k < kDegree - i - j; ++k) xyz *= p.z;
                    coefficient(i, j) += xyz;
                }
            }
        });
        double largest = 0;
        for (int i = 0; i <= kDegree; ++i) {
            for (int j = 0; i + j <= kDegree; ++j) {
                coefficient(i, j) *= factorial[kDegree] / (factorial[i] * factorial[j] * factorial[kDegree - i - j]);
                largest = std::max(largest, std::fabs(coefficient(i, j)));
            }
        }
        if (largest > 0)
            for (double& c : coefficients_) c /= largest;
    }

    void evaluate(const Vec3d& d, Vec3d& gradient, Matrix3& hessian) const {
        double power[3][kDegree + 1];
        for (int a = 0; a < 3; ++a) {
            power[a][0] = 1;
            for (int n = 1; n <= kDegree; ++n) power[a][n] = power[a][n - 1] * d[a];
        }
        gradient = {};
        hessian = Matrix3{} * 0.0;
        for (int i = 0; i <= kDegree; ++i) {
            for (int j = 0; i + j <= kDegree; ++j) {
                const int n[3] = {i, j, kDegree - i - j};
                const double c = coefficients_[index(i, j)];
                for (int a = 0; a < 3; ++a) {
                    if (n[a] == 0) continue;
                    gradient[a] += c * term(power, n, a, -1);
                    for (int b = 0; b < 3; ++b) hessian.row[static_cast<std::size_t>(a)][b] += c * term(power, n, a, b);
                }
            }
        }
    }

private:
    static std::size_t index(int i, int j) { return static_cast<std::size_t>(i * (kDegree + 1) + j); }
    double& coefficient(int i, int j) { return coefficients_[index(i, j)]; }

    // x^i y^j z^k derived by variable a, and by b unless that is -1.
    static double term(const double power[3][kDegree + 1], const int n[3], int a, int b) {
        int m[3] = {n[0], n[1], n[2]};
        double factor = m[a]--;
        if (b >= 0) {
            if (m[b] == 0) return 0;
            factor *= m[b]--;
        }
        return factor * power[0][m[0]] * power[1][m[1]] * power[2][m[2]];
    }

    std::array<double, (kDegree + 1) * (kDegree + 1)> coefficients_{};
};

// Newton's method in the plane across d, a step at most a quarter of a radian; finds maxima, minima and saddles alike.
bool settle(const SixthMoment& f, Vec3d& d) {
    for (int step = 0; step < 40; ++step) {
        Vec3d gradient;
        Matrix3 hessian;
        f.evaluate(d, gradient, hessian);
        const Vec3d u = any_across(d), v = cross(d, u);
        const double radial = dot(gradient, d);  // the sphere bends away from its tangent plane by this
        const double gu = dot(gradient, u), gv = dot(gradient, v);
        const double uu = dot(u, hessian * u) - radial, uv = dot(u, hessian * v), vv = dot(v, hessian * v) - radial;
        const double det = uu * vv - uv * uv, scale = uu * uu + uv * uv + vv * vv;
        if (!(std::fabs(det) > 1e-10 * scale)) return false;
        double du = -(vv * gu - uv * gv) / det, dv = -(uu * gv - uv * gu) / det;
        const double far = std::sqrt(du * du + dv * dv);
        if (far > 0.25) du *= 0.25 / far, dv *= 0.25 / far;
        d += u * du + v * dv;
        d = d / length(d);
        if (far < 1e-12) return true;
    }
    return false;
}

}  // namespace

PrincipalAxes principal_axes(const Surface& surface, const Vec3d& centre) {
    Matrix3 m = Matrix3{} * 0.0, turn;
    over_surface(surface, centre, [&](const Vec3d& p, double weight) {
        for (int i = 0; i < 3; ++i) m.row[static_cast<std::size_t>(i)] += p * (p[i] * weight);
    });
    // Jacobi: rotations that make one pair of elements zero after the other.
    for (int sweep = 0; sweep < 30; ++sweep) {
        for (std::size_t p = 0; p < 2; ++p) {
            for (std::size_t q = p + 1; q < 3; ++q) {
                const int i = static_cast<int>(p), j = static_cast<int>(q);
                const double off = m.row[p][j], scale = std::fabs(m.row[p][i]) + std::fabs(m.row[q][j]);
                if (!(std::fabs(off) > 1e-15 * scale)) continue;
                const double theta = (m.row[q][j] - m.row[p][i]) / (2 * off);
                const double t = (theta < 0 ? -1 : 1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                Matrix3 g;
                g.row[p][i] = g.row[q][j] = c;
                g.row[p][j] = s;
                g.row[q][i] = -s;
                m = transpose(g) * m * g;
                turn = turn * g;
            }
        }
    }
    std::array<int, 3> order{0, 1, 2};
    const auto moment = [&](int i) { return m.row[static_cast<std::size_t>(i)][i]; };
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return moment(a) > moment(b) + 1e-12 * std::fabs(moment(b)); });
    PrincipalAxes result;
    for (std::size_t i = 0; i < 3; ++i) {
        result.moment[i] = moment(order[i]);
        result.axis[i] = turn.column(order[i]);
    }
    if (dot(cross(result.axis[0], result.axis[1]), result.axis[2]) < 0) result.axis[2] = -result.axis[2];
    return result;
}

std::vector<Vec3d> stationary_axes(const Surface& surface, const Vec3d& centre, std::size_t most) {
    // Starts evenly over the upper half of a sphere (Fibonacci); an icosahedron's 31 axes are at least 18 degrees
    // apart.
    constexpr int starts = 400;
    const SixthMoment f(surface, centre);
    std::vector<Vec3d> found;
    for (int s = 0; s < starts && found.size() < most; ++s) {
        const double z = (s + 0.5) / starts, r = std::sqrt(1 - z * z), angle = s * kPi * (3 - std::sqrt(5.0));
        Vec3d d{r * std::cos(angle), r * std::sin(angle), z};
        if (!settle(f, d)) continue;
        const bool known =
            std::any_of(found.begin(), found.end(), [&](const Vec3d& o) { return std::fabs(dot(o, d)) > 0.9998; });
        if (!known) found.push_back(d);
    }
    return found;
}

}  // namespace frm::bake
