#include "bake/mesh/glb_writer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>

#include "bake/error.h"

namespace frm::bake {

namespace {

using Json = nlohmann::ordered_json;

// Numbers of the glTF specification: component types (3.6.2.2), buffer view targets (3.6.1).
constexpr int kFloat = 5126, kUnsignedInt = 5125, kVertices = 34962, kIndices = 34963;

void put(std::string& bytes, const void* value, std::size_t size) {
    bytes.append(static_cast<const char*>(value), size);
}

void put(std::string& bytes, std::uint32_t value) { put(bytes, &value, sizeof value); }

// Adds one part's vertices and corners to `data`, and what describes them to `gltf`.
void add_part(const GlbPart& part, Json& gltf, std::string& data) {
    const Surface& surface = *part.surface;
    const std::size_t view = gltf["bufferViews"].size(), index = gltf["meshes"].size();

    const std::size_t vertices_at = data.size();
    std::array<float, 3> low, high;
    low.fill(std::numeric_limits<float>::max());
    high.fill(std::numeric_limits<float>::lowest());
    for (const Vec3d& v : surface.vertices) {
        for (int i = 0; i < 3; ++i) {
            const auto x = static_cast<float>(v[i]);
            if (!std::isfinite(x)) throw BakeError("write_glb: a coordinate of " + part.name + " is no finite float");
            const auto k = static_cast<std::size_t>(i);
            low[k] = std::min(low[k], x);
            high[k] = std::max(high[k], x);
            put(data, &x, sizeof x);
        }
    }
    const std::size_t corners_at = data.size();
    for (const Triangle& t : surface.triangles) put(data, t.data(), sizeof t);

    gltf["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", vertices_at}, {"byteLength", corners_at - vertices_at}, {"target", kVertices}});
    gltf["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", corners_at}, {"byteLength", data.size() - corners_at}, {"target", kIndices}});
    gltf["accessors"].push_back({{"bufferView", view},
                                 {"componentType", kFloat},
                                 {"count", surface.vertices.size()},
                                 {"type", "VEC3"},
                                 {"min", low},
                                 {"max", high}});
    gltf["accessors"].push_back({{"bufferView", view + 1},
                                 {"componentType", kUnsignedInt},
                                 {"count", 3 * surface.triangles.size()},
                                 {"type", "SCALAR"}});
    Json material{
        {"name", part.name},
        {"pbrMetallicRoughness", {{"baseColorFactor", part.colour}, {"metallicFactor", 0.0}, {"roughnessFactor", 1.0}}},
        {"doubleSided", true}};
    if (part.colour[3] < 1) material["alphaMode"] = "BLEND";
    gltf["materials"].push_back(std::move(material));
    gltf["meshes"].push_back(
        {{"name", part.name},
         {"primitives",
          Json::array({{{"attributes", {{"POSITION", view}}}, {"indices", view + 1}, {"material", index}}})}});
    gltf["nodes"].push_back({{"name", part.name}, {"mesh", index}});
    gltf["scenes"][0]["nodes"].push_back(index);
}

}  // namespace

std::string write_glb(const std::vector<GlbPart>& parts, const std::string& generator) {
    Json gltf{{"asset", {{"version", "2.0"}, {"generator", generator}}}, {"scene", 0}};
    gltf["scenes"] = Json::array({Json::object({{"nodes", Json::array()}})});
    for (const char* list : {"nodes", "meshes", "materials", "accessors", "bufferViews"}) gltf[list] = Json::array();
    std::string data;
    for (const GlbPart& part : parts) {
        if (part.surface && !part.surface->triangles.empty()) add_part(part, gltf, data);
    }
    if (data.empty()) throw BakeError("write_glb: no triangles");
    gltf["buffers"] = Json::array({{{"byteLength", data.size()}}});

    // Chunks end on four bytes: JSON with spaces, data with zeros (ours is whole words already).
    std::string text = gltf.dump(-1, ' ', false, Json::error_handler_t::replace);
    text.append((4 - text.size() % 4) % 4, ' ');
    const std::size_t size = 28 + text.size() + data.size();
    if (size > std::numeric_limits<std::uint32_t>::max()) throw BakeError("write_glb: more than 4 GiB");
    std::string bytes = "glTF";
    bytes.reserve(size);
    put(bytes, 2);
    put(bytes, static_cast<std::uint32_t>(size));
    put(bytes, static_cast<std::uint32_t>(text.size()));
    bytes += "JSON" + text;
    put(bytes, static_cast<std::uint32_t>(data.size()));
    bytes += std::string("BIN\0", 4) + data;
    return bytes;
}

}  // namespace frm::bake
