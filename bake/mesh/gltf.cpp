#include "bake/mesh/gltf.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "bake/mesh/gltf_data.h"
#include "bake/mesh/gltf_file.h"

namespace frm::bake {

namespace {

constexpr std::size_t kMostTriangles = 2'000'000;
constexpr double kLargest = 1000, kSmallest = 0.001;  // m, across

// p -> columns * p + offset
struct Transform {
    Vec3d column[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Vec3d offset;

    Vec3d turn(const Vec3d& v) const { return column[0] * v.x + column[1] * v.y + column[2] * v.z; }
    Vec3d operator()(const Vec3d& p) const { return turn(p) + offset; }
    Transform operator*(const Transform& inner) const {
        return {{turn(inner.column[0]), turn(inner.column[1]), turn(inner.column[2])}, (*this)(inner.offset)};
    }
    double determinant() const { return dot(column[0], cross(column[1], column[2])); }
};

bool finite(const std::vector<double>& values) {
    return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

// A primitive's corners as triangles. Strips turn round every second triangle, fans share their first corner
// (glTF 2.0, 3.7.2.1).
std::vector<Triangle> triangles_of(int mode, const std::vector<std::uint32_t>& corners) {
    std::vector<Triangle> result;
    if (mode == TINYGLTF_MODE_TRIANGLES) {
        for (std::size_t i = 0; i + 3 <= corners.size(); i += 3)
            result.push_back({corners[i], corners[i + 1], corners[i + 2]});
    } else {
        for (std::size_t i = 0; i + 3 <= corners.size(); ++i) {
            if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
                result.push_back({corners[0], corners[i + 1], corners[i + 2]});
            } else {
                result.push_back({corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
            }
        }
    }
    return result;
}

class SceneReader {
public:
    SceneReader(const std::string& path, const tinygltf::Model& model, double scale)
        : path_(path), model_(model), data_(path, model), scale_(scale) {}

    Surface read() {
        check_tree();
        struct Visit {
            std::size_t node;
            Transform parent;
        };
        std::vector<Visit> to_visit;
        for (const std::size_t root : roots()) to_visit.push_back({root, {}});
        std::reverse(to_visit.begin(), to_visit.end());
        while (!to_visit.empty()) {
            const Visit visit = to_visit.back();
            to_visit.pop_back();
            const tinygltf::Node& node = model_.nodes[visit.node];
            const Transform transform = visit.parent * local_transform(visit.node);
            if (node.mesh >= 0) add_mesh(visit.node, transform);
            for (auto child = node.children.rbegin(); child != node.children.rend(); ++child) {
                to_visit.push_back({static_cast<std::size_t>(*child), transform});
            }
        }
        if (surface_.triangles.empty())
            fail_gltf(path_, "", "has no triangles in its scene; export a scene with a mesh");
        return std::move(surface_);
    }

private:
    std::string node_name(std::size_t node) const {
        const std::string& name = model_.nodes[node].name;
        return "node " + (name.empty() ? std::to_string(node) : quoted(name));
    }

    std::string mesh_name(std::size_t mesh) const {
        const std::string& name = model_.meshes[mesh].name;
        return "mesh " + (name.empty() ? std::to_string(mesh) : quoted(name));
    }

    std::size_t node_at(int index, const std::string& element) const {
        if (index < 0 || static_cast<std::size_t>(index) >= model_.nodes.size()) {
            fail_gltf(path_, element,
                      "node " + std::to_string(index) + " does not exist (the file has " +
                          std::to_string(model_.nodes.size()) + "); export it again");
        }
        return static_cast<std::size_t>(index);
    }

    // One parent at most and no node its own ancestor: after this the walk ends and meets every node once.
    void check_tree() {
        constexpr auto none = std::numeric_limits<std::size_t>::max();
        parent_.assign(model_.nodes.size(), none);
        for (std::size_t n = 0; n < model_.nodes.size(); ++n) {
            for (const int child : model_.nodes[n].children) {
                const std::size_t c = node_at(child, node_name(n));
                if (c == n) fail_gltf(path_, node_name(n), "is its own child; remove that link");
                if (parent_[c] != none) {
                    fail_gltf(path_, node_name(c),
                              "has two parents (" + node_name(parent_[c]) + " and " + node_name(n) +
                                  "); give each its own copy");
                }
                parent_[c] = n;
            }
        }
        std::vector<std::size_t> reached;
        for (std::size_t n = 0; n < parent_.size(); ++n) {
            if (parent_[n] == none) reached.push_back(n);
        }
        roots_ = reached;
        for (std::size_t i = 0; i < reached.size(); ++i) {
            for (const int child : model_.nodes[reached[i]].children)
                reached.push_back(static_cast<std::size_t>(child));
        }
        if (reached.size() == parent_.size()) return;
        std::sort(reached.begin(), reached.end());
        std::size_t missing = 0;
        while (missing < reached.size() && reached[missing] == missing) ++missing;
        fail_gltf(path_, node_name(missing), "is in a circle of parents and children; remove one of those links");
    }

    std::vector<std::size_t> roots() const {
        if (model_.defaultScene < 0) {
            if (roots_.empty())
                fail_gltf(path_, "", "has no nodes, so nothing is placed in it; export a scene with a mesh");
            return roots_;
        }
        const auto index = static_cast<std::size_t>(model_.defaultScene);
        const std::string element = "scene " + std::to_string(index);
        if (index >= model_.scenes.size()) {
            fail_gltf(path_, element,
                      "does not exist (the file has " + std::to_string(model_.scenes.size()) + "); export it again");
        }
        std::vector<std::size_t> result;
        for (const int node : model_.scenes[index].nodes) {
            const std::size_t n = node_at(node, element);
            if (!std::binary_search(roots_.begin(), roots_.end(), n)) {
                fail_gltf(path_, element,
                          node_name(n) + " is listed as a root but is a child of " + node_name(parent_[n]) +
                              "; list it once");
            }
            if (std::find(result.begin(), result.end(), n) != result.end()) {
                fail_gltf(path_, element, node_name(n) + " is listed twice; list it once");
            }
            result.push_back(n);
        }
        if (result.empty()) fail_gltf(path_, element, "is empty; export a scene with a mesh");
        return result;
    }

    Transform local_transform(std::size_t index) const {
        const tinygltf::Node& node = model_.nodes[index];
        const auto wrong = [&](const char* what) {
            fail_gltf(path_, node_name(index), std::string(what) + "; apply or clear its transform and export again");
        };
        for (const auto& [values, size] :
             {std::pair{&node.matrix, 16}, {&node.translation, 3}, {&node.rotation, 4}, {&node.scale, 3}}) {
            if (!values->empty() && values->size() != static_cast<std::size_t>(size))
                wrong("its transform has the wrong length");
            if (!finite(*values)) wrong("its transform is not finite");
        }

        Transform result;
        if (!node.matrix.empty()) {
            const std::vector<double>& m = node.matrix;
            if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
                wrong("its matrix is a projection, not a placement");
            for (std::size_t c = 0; c < 3; ++c) result.column[c] = {m[4 * c], m[4 * c + 1], m[4 * c + 2]};
            result.offset = {m[12], m[13], m[14]};
        } else {
            if (!node.rotation.empty()) result = rotation(node.rotation, index);
            for (std::size_t c = 0; c < 3 && !node.scale.empty(); ++c) result.column[c] *= node.scale[c];
            if (!node.translation.empty())
                result.offset = {node.translation[0], node.translation[1], node.translation[2]};
        }
        const double lengths = length(result.column[0]) * length(result.column[1]) * length(result.column[2]);
        if (!(std::fabs(result.determinant()) > 1e-9 * lengths) || !std::isfinite(lengths)) {
            wrong("its transform flattens the shape (a scale of zero?)");
        }
        return result;
    }

    Transform rotation(const std::vector<double>& q, std::size_t index) const {
        const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        if (!(std::fabs(norm - 1) < 0.01)) {
            fail_gltf(path_, node_name(index),
                      "its rotation is not a unit quaternion; apply its rotation and export again");
        }
        const double x = q[0] / norm, y = q[1] / norm, z = q[2] / norm, w = q[3] / norm;
        Transform result;
        result.column[0] = {1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)};
        result.column[1] = {2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)};
        result.column[2] = {2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)};
        return result;
    }

    void add_mesh(std::size_t node_index, const Transform& transform) {
        const tinygltf::Node& node = model_.nodes[node_index];
        if (static_cast<std::size_t>(node.mesh) >= model_.meshes.size()) {
            fail_gltf(path_, node_name(node_index),
                      "mesh " + std::to_string(node.mesh) + " does not exist (the file has " +
                          std::to_string(model_.meshes.size()) + "); export it again");
        }
        const auto mesh_index = static_cast<std::size_t>(node.mesh);
        const tinygltf::Mesh& mesh = model_.meshes[mesh_index];
        const auto bent = [](double weight) { return weight != 0; };
        if (node.skin >= 0) {
            fail_gltf(path_, node_name(node_index),
                      "is bent by a skeleton; a bake takes rigid shapes: apply the armature and "
                      "export again");
        }
        const std::vector<double>& weights = node.weights.empty() ? mesh.weights : node.weights;
        if (std::any_of(weights.begin(), weights.end(), bent)) {
            fail_gltf(path_, mesh_name(mesh_index), "is bent by morph targets; apply the shape keys and export again");
        }
        if (node.extensions.count("EXT_mesh_gpu_instancing") != 0) {
            fail_gltf(path_, node_name(node_index),
                      "uses EXT_mesh_gpu_instancing; make the instances real and export again");
        }
        for (std::size_t p = 0; p < mesh.primitives.size(); ++p) add_primitive(mesh_index, p, transform);
    }

    void add_primitive(std::size_t mesh_index, std::size_t primitive_index, const Transform& transform) {
        const tinygltf::Primitive& primitive = model_.meshes[mesh_index].primitives[primitive_index];
        const std::string element = mesh_name(mesh_index) + ", primitive " + std::to_string(primitive_index);
        if (primitive.mode < TINYGLTF_MODE_TRIANGLES || primitive.mode > TINYGLTF_MODE_TRIANGLE_FAN) {
            const bool known = primitive.mode >= TINYGLTF_MODE_POINTS && primitive.mode < TINYGLTF_MODE_TRIANGLES;
            fail_gltf(path_, element,
                      known ? "is points or lines, not triangles; delete loose points and edges, or give them a "
                              "thickness, and export again"
                            : "has no such mode as " + std::to_string(primitive.mode) + "; export it again");
        }
        const auto position = primitive.attributes.find("POSITION");
        if (position == primitive.attributes.end()) {
            fail_gltf(path_, element, "has no POSITION, so no shape; export it again");
        }
        const std::vector<Vec3d> vertices = data_.positions(position->second, element);
        std::vector<std::uint32_t> corners;
        if (primitive.indices != -1) {
            corners = data_.indices(primitive.indices, vertices.size(), element);
        } else {
            corners.resize(vertices.size());
            for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(i);
        }
        if (corners.size() < 3 || (primitive.mode == TINYGLTF_MODE_TRIANGLES && corners.size() % 3 != 0)) {
            fail_gltf(path_, element,
                      std::to_string(corners.size()) + " corners make no whole triangles; export it again");
        }

        std::vector<Triangle> triangles = triangles_of(primitive.mode, corners);
        if (surface_.triangles.size() + triangles.size() > kMostTriangles) {
            fail_gltf(path_, element,
                      "the file has more than 2 million triangles; simplify it (Blender: Decimate), the water does "
                      "not feel such detail");
        }
        append(vertices, std::move(triangles), transform, element);
    }

    // Takes the used vertices only, so that many instances of a large mesh cost no more than their triangles.
    void append(const std::vector<Vec3d>& vertices, std::vector<Triangle> triangles, const Transform& transform,
                const std::string& element) {
        constexpr auto unused = std::numeric_limits<std::uint32_t>::max();
        std::vector<std::uint32_t> place(vertices.size(), unused);
        const bool mirrored = transform.determinant() < 0;
        for (Triangle& triangle : triangles) {
            for (std::uint32_t& corner : triangle) {
                if (place[corner] == unused) {
                    place[corner] = static_cast<std::uint32_t>(surface_.vertices.size());
                    const Vec3d p = transform(vertices[corner]) * scale_;
                    // Not only infinities: the square of a coordinate must stay finite too.
                    if (!(dot(p, p) < 1e18)) {
                        fail_gltf(path_, element,
                                  "vertex " + std::to_string(corner) +
                                      " lies absurdly far away; glTF is in "
                                      "metres: check the unit and the node's transform");
                    }
                    surface_.vertices.push_back(p);
                }
                corner = place[corner];
            }
            if (mirrored) std::swap(triangle[1], triangle[2]);
            surface_.triangles.push_back(triangle);
        }
    }

    const std::string& path_;
    const tinygltf::Model& model_;
    GltfData data_;
    double scale_;
    Surface surface_;
    std::vector<std::size_t> parent_;
    std::vector<std::size_t> roots_;
};

}  // namespace

Surface load_gltf(const std::string& path, double scale) {
    const auto model = open_gltf(path);
    Surface surface = SceneReader(path, *model, scale).read();
    const double across = longest_side(measure(surface));
    if (across > kLargest || across < kSmallest) {
        fail_gltf(path, "",
                  "the shape is " + std::to_string(across) +
                      " m across; glTF is in metres and 1 mm to 1 km is "
                      "possible: check the unit of the export (millimetres or inches?), or scale it");
    }
    return surface;
}

double extent_of_gltf(const std::string& path) {
    const auto model = open_gltf(path);
    return longest_side(measure(SceneReader(path, *model, 1).read()));
}

}  // namespace frm::bake
