#include "bake/flow/refinement.h"

#include <algorithm>

#include "bake/flow/vectors.h"

namespace frm::bake::flow {
namespace {

/// Memory for the rows of one task: fields, rows between, and populations. A thread keeps its own.
float* scratch(std::size_t count) {
    thread_local std::vector<float> memory;
    if (memory.size() < count) memory.resize(count);
    return memory.data();
}

constexpr float inner_weight = 9.0f / 16, outer_weight = -1.0f / 16;

/// What the coarse block takes from every second fine node must be free of the zigzag from node to node that a lattice of
/// low viscosity has beside walls and corners, or it becomes a flow: unfiltered, the drag of a cube at Re 1e4 was 30 %
/// high. These weights take out the zigzag and leave the rest to fourth order (1 2 1 would blur the flow: a vortex that
/// crossed two borders lost three times as much).
float filtered(float a, float b, float c, float d, float e) { return 0.625f * c + 0.25f * (b + d) - 0.0625f * (a + e); }
constexpr int reach = 2, planes = 2 * reach + 1;  // nodes to each side, and in all

float half_way(float a, float b, float c, float d) { return inner_weight * (b + c) + outer_weight * (a + d); }

/// Of a row, the cells beside the ring of a face across rows, a thread's own.
float* edge(bool high) {
    thread_local float cells[2][field_count * planes];
    return cells[high ? 1 : 0];
}

// Rows of the borders' planes, in time, across and along them.

FRM_FLOW_CLONES
void rows_at_time(const float* a0, const float* a1, float share, std::size_t count, float* to) {
    const float old_share = 1 - share;
    FRM_FLOW_INDEPENDENT
    for (std::size_t u = 0; u < count; ++u) to[u] = old_share * a0[u] + share * a1[u];
}

/// Half-way between the middle two of four rows.
FRM_FLOW_CLONES
void half_way_rows(const float* const* old_rows, const float* const* new_rows, float share, std::size_t count,
                   float* to) {
    const float *const a0 = old_rows[0], *const b0 = old_rows[1], *const c0 = old_rows[2], *const d0 = old_rows[3];
    const float *const a1 = new_rows[0], *const b1 = new_rows[1], *const c1 = new_rows[2], *const d1 = new_rows[3];
    const float old_share = 1 - share;
    FRM_FLOW_INDEPENDENT
    for (std::size_t u = 0; u < count; ++u) {
        to[u] = old_share * half_way(a0[u], b0[u], c0[u], d0[u]) + share * half_way(a1[u], b1[u], c1[u], d1[u]);
    }
}

/// Every second node of `to` is one of the row's, from its second on.
FRM_FLOW_CLONES
void refine_row(const float* row, std::size_t count, float* to) {
    const std::size_t pairs = count / 2;
    FRM_FLOW_INDEPENDENT
    for (std::size_t u = 0; u < pairs; ++u) {
        to[2 * u] = row[u + 1];
        to[2 * u + 1] = half_way(row[u], row[u + 1], row[u + 2], row[u + 3]);
    }
    to[2 * pairs] = row[pairs + 1];
}

FRM_FLOW_CLONES
void filter_rows(const float* const* rows, std::size_t count, float* to) {
    const float *const a = rows[0], *const b = rows[1], *const c = rows[2], *const d = rows[3], *const e = rows[4];
    FRM_FLOW_INDEPENDENT
    for (std::size_t u = 0; u < count; ++u) to[u] = filtered(a[u], b[u], c[u], d[u], e[u]);
}

/// Every second node from the row's fourth on.
FRM_FLOW_CLONES
void coarsen_row(const float* row, std::size_t count, float* to) {
    FRM_FLOW_INDEPENDENT
    for (std::size_t u = 0; u < count; ++u) {
        const float* const c = row + 1 + 2 * u;
        to[u] = filtered(c[0], c[1], c[2], c[3], c[4]);
    }
}

}  // namespace

std::array<int, 3> Refinement::Face::at(int plane, int u_index, int v_index) const {
    std::array<int, 3> p{};
    p[static_cast<std::size_t>(axis)] = plane;
    p[static_cast<std::size_t>(u)] = u_index;
    p[static_cast<std::size_t>(v)] = v_index;
    return p;
}

Line Refinement::Face::line_of(const std::array<int, 3>& p) const {
    return {static_cast<float>(p[0]), static_cast<float>(p[1]), u == 0 ? 1.0f : 0.0f, u == 1 ? 1.0f : 0.0f};
}

Refinement::Range Refinement::Face::mine(int entering, std::size_t count, bool first_row, bool last_row) const {
    const Direction& c = directions[static_cast<std::size_t>(entering)];
    // It enters through the other axis' face as well: at the low end upwards, at the high end downwards.
    const auto shared = [&](int other, bool at_low, bool at_high) {
        return other < axis && ((at_low && c.along(other) > 0) || (at_high && c.along(other) < 0));
    };
    if (!wraps && shared(v, first_row, last_row)) return {0, 0};
    return {shared(u, true, false) ? std::size_t{1} : 0, count - (shared(u, false, true) ? 1 : 0)};
}

Refinement::Refinement(const Block& fine, const Block& coarse, float fine_relaxation, float coarse_relaxation,
                       float smagorinsky)
    : fine_(fine.grid),
      coarse_(coarse.grid),
      fine_relaxation_(fine_relaxation),
      coarse_relaxation_(coarse_relaxation),
      smagorinsky_(smagorinsky) {
    for (int axis = 0; axis < (fine.grid.periodic ? 2 : 3); ++axis) {
        add_face(fine, coarse, axis, false);
        add_face(fine, coarse, axis, true);
    }
    for (std::size_t f = 0; f < faces_.size(); ++f) {
        const Face& face = faces_[f];
        for (int v = 0; v < face.fine_nv; ++v) fill_tasks_.push_back({f, v});
        for (int v = 0; v < face.between_rows(); ++v) filter_tasks_.push_back({f, v});
        const int border = face.wraps ? 0 : 3;
        for (int v = border; v < face.nv - border; ++v) restrict_tasks_.push_back({f, v});
    }
}

std::uint64_t Refinement::bytes(const Grid& fine) {
    const auto x = static_cast<std::uint64_t>(fine.nx), y = static_cast<std::uint64_t>(fine.ny),
               z = static_cast<std::uint64_t>(fine.nz);
    const std::uint64_t across = 2 * y * z, along = 2 * x * (z + (fine.periodic ? 0 : y));
    return (2 * across + (planes + 1) * along) * field_count * sizeof(float);
}

void Refinement::add_face(const Block& fine, const Block& coarse, int axis, bool high) {
    Face face;
    face.axis = axis;
    face.high = high;
    face.u = axis == 0 ? 1 : 0;
    face.v = axis == 2 ? 1 : 2;
    face.wraps = fine.grid.periodic && face.v == 2;
    // Index in the coarse block of the plane of ghosts below the fine block's first node.
    const auto border = [&](int a) {
        return (fine.first[static_cast<std::size_t>(a)] - 1) / 2 - coarse.first[static_cast<std::size_t>(a)];
    };
    const int n = fine.grid.size(axis);
    face.fine = high ? n : -1;
    face.fine_ring = high ? n - 4 : 3;
    face.coarse = border(axis) + (high ? (n + 1) / 2 : 0);
    face.ring = face.coarse + (high ? -2 : 2);
    face.u_first = border(face.u) - 1;
    face.nu = (fine.grid.size(face.u) + 1) / 2 + 3;
    face.fine_nu = fine.grid.size(face.u) + 2;
    if (face.wraps) {
        face.nv = coarse.grid.nz;
        face.fine_nv = fine.grid.nz;
        face.v_scale = fine.grid.nz / coarse.grid.nz;
    } else {
        face.v_first = border(face.v) - 1;
        face.nv = (fine.grid.size(face.v) + 1) / 2 + 3;
        face.fine_nv = fine.grid.size(face.v) + 2;
    }
    std::size_t entering = 0;
    for (int i = 1; i < direction_count; ++i) {
        if (directions[static_cast<std::size_t>(i)].along(axis) == (high ? -1 : 1)) face.inward[entering++] = i;
    }
    const auto size =
        static_cast<std::size_t>(field_count) * static_cast<std::size_t>(face.nu) * static_cast<std::size_t>(face.nv);
    for (std::vector<float>& fields : face.fields) fields.assign(size, 0);
    face.between.assign(static_cast<std::size_t>(field_count) * static_cast<std::size_t>(face.between_rows()) *
                            static_cast<std::size_t>(face.between_count()),
                        0);
    face.kept.assign(
        (axis == 0 ? 1 : planes) * field_count * static_cast<std::size_t>(face.between_rows()) * face.kept_count(), 0);
    faces_.push_back(std::move(face));
}

bool Refinement::Face::holds(int j, int k) const {
    const int plane = (axis == 1 ? j : k) - coarse, along = (axis == 2 ? j : k) - v_first;
    if (along < 0 || along >= nv) return false;
    return axis == 0 ? j >= u_first && j < u_first + nu : plane == 0;
}

int Refinement::Face::plane_of(int j, int k) const {
    const int plane = (axis == 1 ? j : k) - fine_ring + reach;
    return plane >= 0 && plane < planes ? plane : -1;
}

void Refinement::want_coarse(std::size_t row, Wanted& wanted) {
    const int j = coarse_.row_y(row), k = coarse_.row_z(row);
    for (Face& face : faces_) {
        if (!face.holds(j, k)) continue;
        const int v = (face.axis == 2 ? j : k) - face.v_first, u = face.axis == 0 ? j - face.u_first : 0;
        Fields to{};
        for (int f = 0; f < field_count; ++f) to[static_cast<std::size_t>(f)] = face.row(newest_, f, v) + u;
        wanted.add(face.axis == 0 ? face.coarse : face.u_first, face.axis == 0 ? 1 : face.nu, to);
    }
}

void Refinement::want_fine(std::size_t row, Wanted& wanted) {
    const int j = fine_.row_y(row), k = fine_.row_z(row);
    for (Face& face : faces_) {
        Fields to{};
        if (face.axis == 0) {
            float* const cells = edge(face.high);
            for (std::size_t f = 0; f < field_count; ++f) to[f] = cells + f * planes;
            wanted.add(face.fine_ring - reach, planes, to);
            continue;
        }
        const int plane = face.plane_of(j, k);
        if (plane < 0) continue;
        for (int f = 0; f < field_count; ++f) {
            to[static_cast<std::size_t>(f)] = face.kept_row(plane, f, face.axis == 1 ? k : j);
        }
        wanted.add(0, fine_.nx, to);
    }
}

void Refinement::keep_fine(std::size_t row) {
    const int j = fine_.row_y(row), k = fine_.row_z(row);
    for (Face& face : faces_) {
        if (face.axis != 0) continue;
        const float* const cells = edge(face.high);
        for (int f = 0; f < field_count; ++f) {
            const float* const c = cells + f * planes;
            face.kept_row(0, f, k)[j] = filtered(c[0], c[1], c[2], c[3], c[4]);
        }
    }
}

void Refinement::fill(Populations& fine, float share, const float* push, const Turning& turning,
                      std::size_t task) const {
    const Face& face = faces_[fill_tasks_[task].face];
    const int v = fill_tasks_[task].v;
    const auto nu = static_cast<std::size_t>(face.nu), fine_nu = static_cast<std::size_t>(face.fine_nu);
    float* const line = scratch(nu + (field_count + direction_count) * fine_nu);
    float* const fields = line + nu;
    float* const rebuilt = fields + field_count * fine_nu;

    // Coarse rows: one where the fine row lies on it, else the two on each side of it.
    const bool between = face.v_scale == 2 && v % 2 == 1;
    const int below = face.v_scale == 2 ? v / 2 : v;
    int rows[4];
    for (int n = 0; n < 4; ++n) {
        const int r = below + n - 1;
        rows[n] = face.wraps ? (r + 2 * face.nv) % face.nv : r + 1;
    }
    ConstFields in{};
    for (int f = 0; f < field_count; ++f) {
        if (between) {
            const float *before[4], *after[4];
            for (int n = 0; n < 4; ++n) {
                before[n] = face.row(1 - newest_, f, rows[n]);
                after[n] = face.row(newest_, f, rows[n]);
            }
            half_way_rows(before, after, share, nu, line);
        } else {
            rows_at_time(face.row(1 - newest_, f, rows[1]), face.row(newest_, f, rows[1]), share, nu, line);
        }
        float* const out = fields + static_cast<std::size_t>(f) * fine_nu;
        refine_row(line, fine_nu, out);
        in[static_cast<std::size_t>(f)] = out;
    }

    std::array<float*, direction_count> out{};
    for (std::size_t i = 0; i < direction_count; ++i) out[i] = rebuilt + i * fine_nu;
    const auto p = face.at(face.fine, -1, face.wraps ? v : v - 1);
    if (turning.on()) from_middle(turning, face.line_of(p), fine_nu, fields + fine_nu, fields + 2 * fine_nu);
    rebuild(in, fine_nu, 0.5f, fine_relaxation_, smagorinsky_, push, out);
    const auto first = static_cast<std::ptrdiff_t>(fine_.index(p[0], p[1], p[2]));
    const std::ptrdiff_t step = face.axis == 0 ? fine_.stride_y() : 1;
    for (const int i : face.inward) {
        const Range mine = face.mine(i, fine_nu, v == 0, v == face.fine_nv - 1);
        float* const to = fine.at(i) + first;
        const float* const f = out[static_cast<std::size_t>(i)];
        for (std::size_t u = mine.begin; u < mine.end; ++u) to[static_cast<std::ptrdiff_t>(u) * step] = f[u];
    }
}

void Refinement::filter(std::size_t task) {
    Face& face = faces_[filter_tasks_[task].face];
    const int v = filter_tasks_[task].v;
    const std::size_t read = face.kept_count(), count = static_cast<std::size_t>(face.between_count());
    float* const across = scratch(read);
    for (int f = 0; f < field_count; ++f) {
        const float* line = face.kept_row(0, f, v);
        if (face.axis != 0) {
            const float* rows[planes];
            for (int n = 0; n < planes; ++n) rows[n] = face.kept_row(n, f, v);
            filter_rows(rows, read, across);
            line = across;
        }
        coarsen_row(line, count, face.between_row(f, v));
    }
}

void Refinement::restrict_to(Populations& coarse, const float* push, const Turning& turning, std::size_t task) const {
    const Face& face = faces_[restrict_tasks_[task].face];
    const int v = restrict_tasks_[task].v;  // of the coarse rows kept
    const int fine_v = face.wraps ? v * face.v_scale : 2 * v - 3;
    const auto count = static_cast<std::size_t>(face.between_count());
    float* const kept = scratch((field_count + direction_count) * count);
    float* const rebuilt = kept + field_count * count;
    ConstFields in{};
    for (int f = 0; f < field_count; ++f) {
        float* const to = kept + static_cast<std::size_t>(f) * count;
        if (face.v_scale == 1) {
            const float* const row = face.between_row(f, fine_v);
            std::copy(row, row + count, to);
        } else {
            const float* rows[planes];
            for (int n = 0; n < planes; ++n) {
                const int layer = fine_v + n - reach;
                rows[n] = face.between_row(f, face.wraps ? (layer + fine_.nz) % fine_.nz : layer);
            }
            filter_rows(rows, count, to);
        }
        in[static_cast<std::size_t>(f)] = to;
    }
    std::array<float*, direction_count> out{};
    for (std::size_t i = 0; i < direction_count; ++i) out[i] = rebuilt + i * count;
    const auto p = face.at(face.ring, face.u_first + 3, face.v_first + v);
    if (turning.on()) from_middle(turning, face.line_of(p), count, kept + count, kept + 2 * count);
    rebuild(in, count, 2.0f, coarse_relaxation_, smagorinsky_, push, out);
    const auto first = static_cast<std::ptrdiff_t>(coarse_.index(p[0], p[1], p[2]));
    const std::ptrdiff_t step = face.axis == 0 ? coarse_.stride_y() : 1;
    for (const int i : face.inward) {
        const Range mine = face.mine(i, count, v == 3, v == face.nv - 4);
        float* const to = coarse.at(opposite(i)) + first;
        const float* const f = out[static_cast<std::size_t>(opposite(i))];
        for (std::size_t u = mine.begin; u < mine.end; ++u) to[static_cast<std::ptrdiff_t>(u) * step] = f[u];
    }
}

}  // namespace frm::bake::flow
