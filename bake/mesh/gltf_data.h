// Checked reading of glTF accessors: tinygltf passes on any index, type, count and byte range a file states.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/math/vec.h"

namespace tinygltf {
class Model;
struct Accessor;
}  // namespace tinygltf

namespace frm::bake {

class GltfData {
public:
    /// Both are kept by reference and must outlive this.
    GltfData(const std::string& path, const tinygltf::Model& model) : path_(path), model_(model) {}

    /// Vertex positions, every number finite. Floats, or the integers of KHR_mesh_quantization; sparse is applied.
    /// `element` names the primitive in the error.
    std::vector<Vec3d> positions(int accessor, const std::string& element) const;

    /// Indices, each below `vertex_count`.
    std::vector<std::uint32_t> indices(int accessor, std::size_t vertex_count, const std::string& element) const;

private:
    // Where `count` elements lie; every byte of them is inside the buffer.
    struct Span {
        const unsigned char* data = nullptr;
        std::size_t stride = 0;
    };

    const tinygltf::Accessor& accessor_at(int index, const std::string& element) const;
    Span span(int view, std::size_t offset, std::size_t count, std::size_t element_size, std::size_t component_size,
              const std::string& element) const;

    const std::string& path_;
    const tinygltf::Model& model_;
};

}  // namespace frm::bake
