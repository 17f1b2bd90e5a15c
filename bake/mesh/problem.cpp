#include "bake/mesh/problem.h"

#include <algorithm>
#include <cmath>

#include "bake/mesh/glb_writer.h"

namespace frm::bake {

namespace {

constexpr double kHalfWidth = 0.003;       // of a mark, over the size
constexpr std::size_t kMostMarks = 20000;  // of each kind: a few megabytes

// The eight corners are middle +- a +- b +- c.
void add_block(Surface& to, const Vec3d& middle, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const auto base = static_cast<std::uint32_t>(to.vertices.size());
    for (int i = 0; i < 8; ++i) {
        to.vertices.push_back(middle + a * ((i & 1) != 0 ? 1.0 : -1.0) + b * ((i & 2) != 0 ? 1.0 : -1.0) +
                              c * ((i & 4) != 0 ? 1.0 : -1.0));
    }
    constexpr std::uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                           {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : faces) {
        to.triangles.push_back({base + f[0], base + f[1], base + f[2]});
        to.triangles.push_back({base + f[0], base + f[2], base + f[3]});
    }
}

Vec3d unit_across(const Vec3d& axis) {
    int smallest = 0;
    for (int i = 1; i < 3; ++i) {
        if (std::fabs(axis[i]) < std::fabs(axis[smallest])) smallest = i;
    }
    Vec3d helper;
    helper[smallest] = 1;
    const Vec3d across = cross(axis, helper);
    return across / length(across);
}

void add_bar(Surface& to, const std::array<Vec3d, 2>& edge, double half_width) {
    const Vec3d along = edge[1] - edge[0];
    const double whole = length(along);
    const Vec3d axis = whole > 0 ? along / whole : Vec3d(1, 0, 0);
    const Vec3d side = unit_across(axis);
    add_block(to, (edge[0] + edge[1]) * 0.5, axis * (0.5 * whole + half_width), side * half_width,
              cross(axis, side) * half_width);
}

void add_plate(Surface& to, const std::array<Vec3d, 3>& corners, double half_width) {
    const Vec3d normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const double norm = length(normal);
    if (!(norm > 0)) {
        for (std::size_t i = 0; i < 3; ++i) add_bar(to, {corners[i], corners[(i + 1) % 3]}, half_width);
        return;
    }
    const auto base = static_cast<std::uint32_t>(to.vertices.size());
    for (const double side : {-1.0, 1.0}) {
        for (const Vec3d& corner : corners) to.vertices.push_back(corner + normal * (side * half_width / norm));
    }
    to.triangles.push_back({base, base + 2, base + 1});
    to.triangles.push_back({base + 3, base + 4, base + 5});
    for (std::uint32_t i = 0; i < 3; ++i) {
        const std::uint32_t j = (i + 1) % 3;
        to.triangles.push_back({base + i, base + j, base + 3 + j});
        to.triangles.push_back({base + i, base + 3 + j, base + 3 + i});
    }
}

template <typename Place, typename Draw>
void draw_some(const std::vector<Place>& places, Draw draw) {
    const std::size_t step = places.size() / kMostMarks + 1;
    for (std::size_t i = 0; i < places.size(); i += step) draw(places[i]);
}

}  // namespace

std::string problem_glb(const MeshError& error) {
    const SurfaceProperties box = measure(error.surface());
    const Vec3d extent = box.high - box.low;
    const double half_width = kHalfWidth * std::max({extent.x, extent.y, extent.z});
    const Marks& marks = error.marks();
    Surface red;
    draw_some(marks.points, [&](const Vec3d& p) {
        add_block(red, p, {2 * half_width, 0, 0}, {0, 2 * half_width, 0}, {0, 0, 2 * half_width});
    });
    draw_some(marks.edges, [&](const std::array<Vec3d, 2>& e) { add_bar(red, e, half_width); });
    draw_some(marks.triangles, [&](const std::array<Vec3d, 3>& t) { add_plate(red, t, half_width); });
    return write_glb({{"surface", {0.5, 0.5, 0.5, 0.5}, &error.surface()}, {"problem", {0.8, 0.0, 0.0, 1.0}, &red}},
                     kProblemGenerator);
}

}  // namespace frm::bake
