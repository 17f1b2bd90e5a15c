#include "bake/mesh/gltf_data.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "bake/mesh/gltf_file.h"

namespace frm::bake {

namespace {

// Above what two million triangles can use; a sparse accessor may state any count without having the bytes.
constexpr std::size_t kMostElements = 6'000'000;

std::size_t component_size(int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return 1;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return 2;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return 4;
        default:
            return 0;
    }
}

template <typename T>
T read(const unsigned char* from) {
    T value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

// Integers become their value, or -1 to 1 where the accessor is normalised (glTF 2.0, 3.11).
double read_component(const unsigned char* from, int type, bool normalized) {
    double value = 0, largest = 1;
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            value = read<std::int8_t>(from);
            largest = 127;
            break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            value = *from;
            largest = 255;
            break;
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            value = read<std::int16_t>(from);
            largest = 32767;
            break;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            value = read<std::uint16_t>(from);
            largest = 65535;
            break;
        case TINYGLTF_COMPONENT_TYPE_FLOAT:
            return static_cast<double>(read<float>(from));
        default:
            break;
    }
    return normalized ? std::max(value / largest, -1.0) : value;
}

std::uint32_t read_index(const unsigned char* from, int type) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return *from;
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return read<std::uint16_t>(from);
        default:
            return read<std::uint32_t>(from);
    }
}

bool is_index_type(int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

std::string of_count(std::size_t count) { return " (the file has " + std::to_string(count) + ")"; }

}  // namespace

const tinygltf::Accessor& GltfData::accessor_at(int index, const std::string& element) const {
    if (index < 0 || static_cast<std::size_t>(index) >= model_.accessors.size()) {
        fail_gltf(path_, element,
                  "accessor " + std::to_string(index) + " does not exist" + of_count(model_.accessors.size()) +
                      "; export it again");
    }
    const tinygltf::Accessor& accessor = model_.accessors[static_cast<std::size_t>(index)];
    if (accessor.count == 0 || accessor.count > kMostElements) {
        fail_gltf(path_, element,
                  "accessor " + std::to_string(index) + " has " + std::to_string(accessor.count) + " elements; 1 to " +
                      std::to_string(kMostElements) + " are possible");
    }
    return accessor;
}

GltfData::Span GltfData::span(int view_index, std::size_t offset, std::size_t count, std::size_t element_size,
                              std::size_t component, const std::string& element) const {
    if (view_index < 0 || static_cast<std::size_t>(view_index) >= model_.bufferViews.size()) {
        fail_gltf(path_, element,
                  "bufferView " + std::to_string(view_index) + " does not exist" + of_count(model_.bufferViews.size()) +
                      "; export it again");
    }
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(view_index)];
    const std::string where = element + ", bufferView " + std::to_string(view_index);
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model_.buffers.size()) {
        fail_gltf(path_, where,
                  "buffer " + std::to_string(view.buffer) + " does not exist" + of_count(model_.buffers.size()) +
                      "; export it again");
    }
    const std::vector<unsigned char>& data = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset) {
        fail_gltf(path_, where,
                  "reaches past the end of buffer " + std::to_string(view.buffer) + " (" + std::to_string(data.size()) +
                      " bytes); export it again");
    }
    const std::size_t stride = view.byteStride == 0 ? element_size : view.byteStride;
    if (stride < element_size || stride > 252) {
        fail_gltf(path_, where,
                  "byteStride " + std::to_string(stride) + " does not fit elements of " + std::to_string(element_size) +
                      " bytes; export it again");
    }
    if (offset % component != 0 || view.byteOffset % component != 0 || stride % component != 0) {
        fail_gltf(
            path_, where,
            "its data is not aligned to its components of " + std::to_string(component) + " bytes; export it again");
    }
    // count is at most kMostElements and stride at most 252: the product fits.
    const std::size_t needed = (count - 1) * stride + element_size;
    if (offset > view.byteLength || needed > view.byteLength - offset) {
        fail_gltf(path_, where,
                  std::to_string(count) + " elements from byte " + std::to_string(offset) + " reach past its end (" +
                      std::to_string(view.byteLength) + " bytes); export it again");
    }
    return {data.data() + view.byteOffset + offset, stride};
}

std::vector<Vec3d> GltfData::positions(int index, const std::string& element) const {
    const tinygltf::Accessor& accessor = accessor_at(index, element);
    const std::string where = element + ", accessor " + std::to_string(index);
    const int type = accessor.componentType;
    const std::size_t component = component_size(type);
    if (accessor.type != TINYGLTF_TYPE_VEC3) fail_gltf(path_, where, "POSITION must be VEC3; export it again");
    if (component == 0 || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
        fail_gltf(path_, where,
                  "POSITION has component type " + std::to_string(type) +
                      "; float (5126), or 8 or 16 bit "
                      "integers (KHR_mesh_quantization) are read");
    }

    const auto read_vertex = [&](const unsigned char* from) {
        Vec3d p;
        for (int i = 0; i < 3; ++i) {
            p[i] = read_component(from + static_cast<std::size_t>(i) * component, type, accessor.normalized);
        }
        return p;
    };
    std::vector<Vec3d> result(accessor.count);
    if (accessor.bufferView >= 0) {
        const Span from =
            span(accessor.bufferView, accessor.byteOffset, accessor.count, 3 * component, component, where);
        for (std::size_t i = 0; i < accessor.count; ++i) result[i] = read_vertex(from.data + i * from.stride);
    } else if (!accessor.sparse.isSparse) {
        fail_gltf(path_, where, "has no bufferView, so no data (is it compressed?); export again without compression");
    }

    if (accessor.sparse.isSparse) {
        const auto& sparse = accessor.sparse;
        const std::string sparse_where = where + ", sparse";
        if (sparse.count < 1 || static_cast<std::size_t>(sparse.count) > accessor.count ||
            sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0 ||
            !is_index_type(sparse.indices.componentType)) {
            fail_gltf(path_, sparse_where, "its count, byteOffset or index type is not possible; export it again");
        }
        const auto count = static_cast<std::size_t>(sparse.count);
        const std::size_t index_size = component_size(sparse.indices.componentType);
        const Span at = span(sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), count,
                             index_size, index_size, sparse_where);
        const Span values = span(sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), count,
                                 3 * component, component, sparse_where);
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t vertex = read_index(at.data + i * at.stride, sparse.indices.componentType);
            if (vertex >= accessor.count) {
                fail_gltf(path_, sparse_where,
                          "index " + std::to_string(vertex) + " points past the accessor's " +
                              std::to_string(accessor.count) + " elements; export it again");
            }
            result[vertex] = read_vertex(values.data + i * values.stride);
        }
    }

    for (std::size_t i = 0; i < result.size(); ++i) {
        if (!std::isfinite(result[i].x) || !std::isfinite(result[i].y) || !std::isfinite(result[i].z)) {
            fail_gltf(path_, where,
                      "vertex " + std::to_string(i) + " is not a finite number; repair or remove that vertex");
        }
    }
    return result;
}

std::vector<std::uint32_t> GltfData::indices(int index, std::size_t vertex_count, const std::string& element) const {
    const tinygltf::Accessor& accessor = accessor_at(index, element);
    const std::string where = element + ", accessor " + std::to_string(index);
    if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_index_type(accessor.componentType)) {
        fail_gltf(path_, where, "indices must be scalars of unsigned 8, 16 or 32 bits; export it again");
    }
    if (accessor.sparse.isSparse)
        fail_gltf(path_, where, "sparse indices are not read; export again without sparse accessors");
    const std::size_t size = component_size(accessor.componentType);
    const Span from = span(accessor.bufferView, accessor.byteOffset, accessor.count, size, size, where);
    std::vector<std::uint32_t> result(accessor.count);
    for (std::size_t i = 0; i < result.size(); ++i) {
        result[i] = read_index(from.data + i * from.stride, accessor.componentType);
        if (result[i] >= vertex_count) {
            fail_gltf(path_, where,
                      "index " + std::to_string(result[i]) + " at position " + std::to_string(i) +
                          " points past the primitive's " + std::to_string(vertex_count) +
                          " vertices; export it again");
        }
    }
    return result;
}

}  // namespace frm::bake
