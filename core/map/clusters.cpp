#include "core/map/clusters.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/map/map.h"

namespace frm {
namespace {

struct Face {
    Vec3d corner[3];  ///< from the centre of the body
    Vec3d normal;     ///< vector area
    double area = 0;

    Vec3d middle() const { return (corner[0] + corner[1] + corner[2]) / 3.0; }
    Vec3d facing() const { return area > 0 ? normal / area : Vec3d(); }
};

using Faces = std::pmr::vector<Face>;

/// The axis along which a set of points spreads most, and how far.
struct Spread {
    int axis = 0;
    double length = 0, middle = 0;
};

template <typename Of>
Spread spread_of(const Face* first, std::size_t count, Of&& of) {
    Vec3d low = of(first[0]), high = low;
    for (std::size_t i = 1; i < count; ++i) {
        const Vec3d p = of(first[i]);
        for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
    }
    Spread s;
    for (int k = 0; k < 3; ++k)
        if (high[k] - low[k] > s.length) s = {k, high[k] - low[k], 0.5 * (high[k] + low[k])};
    return s;
}

/// Splits faces until a set fits into a cluster and faces one way: first where normals turn by more than half a unit (the
/// edges of a box: a wedge has no plane to be sampled along), then in half along the longest side, by whole batches so
/// that few lanes stay empty. Calls add(first, count) for each, in order.
template <typename Add>
void split(Face* first, std::size_t count, Add&& add) {
    const Spread turn = spread_of(first, count, [](const Face& f) { return f.facing(); });
    if (count > 1 && turn.length > 0.5) {
        Face* const middle = std::stable_partition(first, first + count,
                                                   [&](const Face& f) { return f.facing()[turn.axis] < turn.middle; });
        const auto low = static_cast<std::size_t>(middle - first);
        if (low > 0 && low < count) {
            split(first, low, add);
            split(middle, count - low, add);
            return;
        }
    }
    if (count <= Clusters::capacity) {
        add(first, count);
        return;
    }
    const Spread side = spread_of(first, count, [](const Face& f) { return f.middle(); });
    std::stable_sort(first, first + count,
                     [&](const Face& a, const Face& b) { return a.middle()[side.axis] < b.middle()[side.axis]; });
    const std::size_t batches = (count + kernel_lanes - 1) / kernel_lanes, low = (batches / 2) * kernel_lanes;
    split(first, low, add);
    split(first + low, count - low, add);
}

struct Moments {
    double moment[4][6] = {};
    Vec3d centroid;
    double area = 0;
};

/// integral over a triangle of (u . (X - c)) X, u a unit vector: A/12 [(sum d)(sum X) + sum d X] with d at the corners.
Vec3d linear_integral(const Face& f, const Vec3d& c, int axis) {
    double d[3], sum = 0;
    Vec3d corners, products;
    for (int k = 0; k < 3; ++k) {
        d[k] = f.corner[k][axis] - c[axis];
        sum += d[k];
        corners += f.corner[k];
        products += f.corner[k] * d[k];
    }
    return (corners * sum + products) * (1.0 / 12);
}

Moments moments_of(const Face* first, std::size_t count) {
    Moments m;
    for (std::size_t i = 0; i < count; ++i) {
        m.area += first[i].area;
        m.centroid += first[i].middle() * first[i].area;
    }
    m.centroid = m.area > 0 ? m.centroid / m.area : first[0].middle();
    for (std::size_t i = 0; i < count; ++i) {
        const Face& f = first[i];
        const Vec3d arm = cross(f.middle(), f.normal);
        for (int k = 0; k < 3; ++k) {
            m.moment[0][k] += f.normal[k];
            m.moment[0][3 + k] += arm[k];
        }
        for (int axis = 0; axis < 3; ++axis) {
            const double d = f.middle()[axis] - m.centroid[axis];
            const Vec3d turned = cross(linear_integral(f, m.centroid, axis), f.normal);
            for (int k = 0; k < 3; ++k) {
                m.moment[axis + 1][k] += d * f.normal[k];
                m.moment[axis + 1][3 + k] += turned[k];
            }
        }
    }
    return m;
}

/// Eigenvectors of a symmetric matrix, the largest eigenvalue first: by Jacobi rotations, a fixed number of them so that
/// every machine does the same.
void principal_axes(double a[3][3], Vec3d axis[3], double value[3]) {
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int sweep = 0; sweep < 12; ++sweep) {
        for (int p = 0; p < 2; ++p) {
            for (int q = p + 1; q < 3; ++q) {
                if (a[p][q] == 0) continue;
                const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
                const double t = (theta >= 0 ? 1 : -1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
                const double c = 1 / std::sqrt(t * t + 1), s = t * c;
                if (!std::isfinite(t)) continue;
                for (int k = 0; k < 3; ++k) {
                    const double x = a[k][p], y = a[k][q];
                    a[k][p] = c * x - s * y, a[k][q] = s * x + c * y;
                }
                for (int k = 0; k < 3; ++k) {
                    const double x = a[p][k], y = a[q][k];
                    a[p][k] = c * x - s * y, a[q][k] = s * x + c * y;
                }
                for (int k = 0; k < 3; ++k) {
                    const double x = v[k][p], y = v[k][q];
                    v[k][p] = c * x - s * y, v[k][q] = s * x + c * y;
                }
            }
        }
    }
    int order[3] = {0, 1, 2};
    for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2 - i; ++j)
            if (a[order[j]][order[j]] < a[order[j + 1]][order[j + 1]]) std::swap(order[j], order[j + 1]);
    for (int k = 0; k < 3; ++k) {
        axis[k] = {v[0][order[k]], v[1][order[k]], v[2][order[k]]};
        value[k] = std::max(0.0, a[order[k]][order[k]]);
    }
}

void put(ClusterBlock& block, std::size_t lane, const Face* first, std::size_t count) {
    const Moments m = moments_of(first, count);
    double second[3][3] = {};
    for (std::size_t i = 0; i < count; ++i)
        for (int p = 0; p < 3; ++p) {
            const Vec3d column = linear_integral(first[i], m.centroid, p) * first[i].area;
            const Vec3d even = m.centroid * ((first[i].middle()[p] - m.centroid[p]) * first[i].area);
            for (int q = 0; q < 3; ++q) second[p][q] += column[q] - even[q];
        }
    Vec3d axis[3];
    double variance[3];
    principal_axes(second, axis, variance);
    for (int k = 0; k < 4; ++k)
        for (int c = 0; c < 6; ++c) block.moment[k][c][lane] = static_cast<float>(m.moment[k][c]);
    block.area[lane] = static_cast<float>(m.area);
    for (int k = 0; k < 3; ++k) {
        double extent = 0;
        for (std::size_t i = 0; i < count; ++i)
            for (const Vec3d& p : first[i].corner) extent = std::max(extent, std::fabs(dot(p - m.centroid, axis[k])));
        block.extent[k][lane] = static_cast<float>(extent * (1 + 1e-6));
        block.centroid[k][lane] = static_cast<float>(m.centroid[k]);
        for (int c = 0; c < 3; ++c) block.axis[k][c][lane] = static_cast<float>(axis[k][c]);
    }
    for (int k = 0; k < 2; ++k) {
        const double r = m.area > 0 ? std::sqrt(2 * variance[k] / m.area) : 0.0;
        const float inverse = static_cast<float>(0.5 / r);
        block.per_span[k][lane] = r > 0 && std::isfinite(inverse) ? inverse : 0.0f;
        for (int c = 0; c < 3; ++c) {
            block.point[c][2 * k][lane] = static_cast<float>(m.centroid[c] + r * axis[k][c]);
            block.point[c][2 * k + 1][lane] = static_cast<float>(m.centroid[c] - r * axis[k][c]);
        }
    }
}

void put(TriangleBatch& batch, std::size_t lane, const Face& f) {
    for (std::size_t k = 0; k < 3; ++k) {
        batch.x[k][lane] = static_cast<float>(f.corner[k].x);
        batch.y[k][lane] = static_cast<float>(f.corner[k].y);
        batch.z[k][lane] = static_cast<float>(f.corner[k].z);
        batch.normal[k][lane] = static_cast<float>(f.normal[static_cast<int>(k)]);
    }
    batch.area[lane] = static_cast<float>(f.area);
}

}  // namespace

void Clusters::build(const Map& map) {
    const Vec3d middle = (Vec3d(map.shape.low) + Vec3d(map.shape.high)) * 0.5;
    centre = Vec3f(middle);
    half = Vec3f((Vec3d(map.shape.high) - Vec3d(map.shape.low)) * 0.5);
    radius = 0;
    Faces all(batches.get_allocator());
    all.reserve(map.triangles.size());
    for (const auto& t : map.triangles) {
        Face f;
        for (std::size_t k = 0; k < 3; ++k) {
            f.corner[k] = Vec3d(map.vertices[t[k]]) - Vec3d(centre);
            radius = std::max(radius, static_cast<float>(length(f.corner[k])));
        }
        f.normal = cross(f.corner[1] - f.corner[0], f.corner[2] - f.corner[0]) * 0.5;
        f.area = length(f.normal);
        all.push_back(f);
    }
    radius *= 1 + 1e-6f;
    const Moments m = moments_of(all.data(), all.size());
    for (int k = 0; k < 4; ++k)
        for (int c = 0; c < 6; ++c) whole.moment[k][c] = static_cast<float>(m.moment[k][c]);
    for (int k = 0; k < 3; ++k) whole.centroid[k] = static_cast<float>(m.centroid[k]);
    whole.area = static_cast<float>(m.area);

    batches.clear(), blocks.clear(), first_batch.clear(), region_begin.clear();
    std::size_t clusters = 0;
    const auto add = [&](const Face* first, std::size_t count) {
        if (clusters % kernel_lanes == 0) blocks.push_back({});
        put(blocks.back(), clusters++ % kernel_lanes, first, count);
        first_batch.push_back(static_cast<std::uint32_t>(batches.size()));
        for (std::size_t i = 0; i < count; ++i) {
            if (i % kernel_lanes == 0) batches.push_back({});
            put(batches.back(), i % kernel_lanes, first[i]);
        }
    };
    for (std::size_t l = 0; l + 1 < map.region_begin.size(); ++l) {
        region_begin.push_back(static_cast<std::uint32_t>(clusters));
        split(all.data() + map.region_begin[l], map.region_begin[l + 1] - map.region_begin[l], add);
    }
    region_begin.push_back(static_cast<std::uint32_t>(clusters));
    first_batch.push_back(static_cast<std::uint32_t>(batches.size()));

    sampled = half;
    overshoot = 0;
    for (std::size_t k = 0; k < clusters; ++k) {
        const ClusterBlock& block = blocks[k / kernel_lanes];
        const std::size_t lane = k % kernel_lanes;
        for (int c = 0; c < 3; ++c)
            for (const auto& point : block.point[c]) sampled[c] = std::max(sampled[c], std::fabs(point[lane]));
        overshoot = std::max(overshoot, block.extent[0][lane] * block.per_span[0][lane] +
                                            block.extent[1][lane] * block.per_span[1][lane]);
    }
}

}  // namespace frm
