// Surfaces: their measures, glTF files good and broken, and what repair() mends or refuses.
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "bake/mesh/adjacency.h"
#include "bake/mesh/gltf.h"
#include "bake/mesh/repair.h"
#include "bake/mesh/roundness.h"
#include "bake/mesh/surface.h"
#include "tests/support/catch.h"
#include "tests/support/samples.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;
using test::inside_out;
using test::joined;

namespace {

constexpr double kPi = 3.14159265358979323846;

const std::filesystem::path& folder() {
    static const struct Folder {
        std::filesystem::path path =
            std::filesystem::temp_directory_path() /
            ("frm-mesh-" + std::to_string(std::chrono::steady_clock::now().time_since_epoch().count()));
        Folder() { std::filesystem::create_directories(path); }
        ~Folder() {
            std::error_code ignored;
            std::filesystem::remove_all(path, ignored);
        }
    } instance;
    return instance.path;
}

std::string write(const std::string& name, const std::string& content) {
    const std::string path = (folder() / name).string();
    std::ofstream(path, std::ios::binary) << content;
    return path;
}

template <typename T>
void put(std::string& bytes, T value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// The box of 0.4 x 0.3 x 0.2 m: eight positions, then 36 indices of 16 bits.
std::string box_data() {
    const Surface s = test::box({0.4, 0.3, 0.2});
    std::string bytes;
    for (const Vec3d& v : s.vertices) {
        for (int i = 0; i < 3; ++i) put(bytes, static_cast<float>(v[i]));
    }
    for (const Triangle& t : s.triangles) {
        for (const std::uint32_t v : t) put(bytes, static_cast<std::uint16_t>(v));
    }
    return bytes;
}

const std::string kBox = R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],
"nodes":[{"name":"body","mesh":0}],
"meshes":[{"name":"hull","primitives":[{"attributes":{"POSITION":0},"indices":1,"mode":4}]}],
"accessors":[{"bufferView":0,"componentType":5126,"count":8,"type":"VEC3"},{"bufferView":1,"componentType":5123,"count":36,"type":"SCALAR"}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":72}],
"buffers":[{"uri":"box.bin","byteLength":168}]})";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

std::string glb(std::string json, std::string data) {
    while (json.size() % 4 != 0) json += ' ';
    while (data.size() % 4 != 0) data += '\0';
    std::string bytes = "glTF";
    put(bytes, std::uint32_t{2});
    put(bytes, static_cast<std::uint32_t>(28 + json.size() + data.size()));
    put(bytes, static_cast<std::uint32_t>(json.size()));
    bytes += "JSON" + json;
    put(bytes, static_cast<std::uint32_t>(data.size()));
    return bytes + std::string("BIN\0", 4) + data;
}

Surface load_box(const std::string& json) {
    write("box.bin", box_data());
    return load_gltf(write("box.gltf", json));
}

// The text of the BakeError, or "" when there is none. Any other exception fails the test.
std::string error_of(const std::function<void()>& run) {
    try {
        run();
    } catch (const BakeError& e) {
        return e.what();
    }
    return "";
}

// Every triangle with vertices of its own, as an exporter of flat shaded faces writes them.
Surface unwelded(const Surface& s) {
    Surface result;
    for (std::size_t t = 0; t < s.triangles.size(); ++t) {
        const auto base = static_cast<std::uint32_t>(result.vertices.size());
        for (int i = 0; i < 3; ++i) result.vertices.push_back(s.corner(t, i));
        result.triangles.push_back({base, base + 1, base + 2});
    }
    return result;
}

bool mentions(const std::vector<std::string>& notes, const std::string& text) {
    for (const std::string& note : notes) {
        if (note.find(text) != std::string::npos) return true;
    }
    return false;
}

}  // namespace

TEST_CASE("measures of known shapes", "[mesh]") {
    const SurfaceProperties box = measure(test::moved(test::box({0.4, 0.3, 0.2}), {5, -7, 900}));
    CHECK(box.volume == Approx(0.024));
    CHECK(box.area == Approx(0.52));
    CHECK(length(box.centroid - Vec3d(5, -7, 900)) < 1e-9);
    CHECK(box.low.x == Approx(4.8));
    CHECK(box.high.z == Approx(900.1));

    const SurfaceProperties sphere = measure(test::icosphere(0.05, 4));
    CHECK(sphere.volume == Approx(4.0 / 3 * kPi * 1.25e-4).epsilon(0.005));
    CHECK(sphere.area == Approx(4 * kPi * 0.0025).epsilon(0.005));
    CHECK(measure(Surface{}).volume == 0);
}

TEST_CASE("shadows", "[mesh]") {
    const Surface box = test::box({0.4, 0.3, 0.2});
    const Vec3d d = Vec3d(1, 2, 3) / std::sqrt(14.0);
    CHECK(projected_area(box, {1, 0, 0}) == Approx(0.06).epsilon(1e-9));
    CHECK(projected_area(box, {0, -1, 0}) == Approx(0.08).epsilon(1e-9));
    CHECK(projected_area(box, d) == Approx(d.x * 0.06 + d.y * 0.08 + d.z * 0.12).epsilon(1e-5));
    CHECK(projected_area(test::icosphere(1, 5), d) == Approx(kPi).epsilon(0.002));
    CHECK(projected_area(test::cylinder(0.1, 1, 200), {0, 1, 0}) == Approx(0.2).epsilon(0.001));
    // Overlapping parts are counted once, apart ones both, wherever the body is.
    const Surface far_box = test::moved(box, {0.2, 0, 10});
    CHECK(projected_area(joined(box, far_box), {0, 0, 1}) == Approx(0.18).epsilon(1e-6));
    CHECK(projected_area(joined(box, far_box), {1, 0, 0}) == Approx(0.12).epsilon(1e-3));
    CHECK(projected_area(test::moved(box, {300, 400, -500}), d) == Approx(projected_area(box, d)).epsilon(1e-8));
    CHECK(projected_area(box, d) == projected_area(box, d));
    CHECK_THROWS_AS(projected_area(box, {0, 0, 0}), BakeError);
}

TEST_CASE("a glTF file with its data beside it or inside", "[gltf]") {
    CHECK(measure(load_box(kBox)).volume == Approx(0.024));
    const std::string inner = replaced(kBox, R"("uri":"box.bin",)", "");
    CHECK(measure(load_gltf(write("inner.glb", glb(inner, box_data())))).volume == Approx(0.024));
    // The container is told by its first bytes, not by its name.
    CHECK(measure(load_gltf(write("misnamed.gltf", glb(inner, box_data())))).volume == Approx(0.024));
    // Pictures are not needed.
    const std::string pictured =
        replaced(kBox, R"("buffers")", R"("images":[{"uri":"missing.png"}],"textures":[{"source":0}],"buffers")");
    CHECK(measure(load_box(pictured)).volume == Approx(0.024));
}

TEST_CASE("node transforms are applied", "[gltf]") {
    const std::string node = R"({"name":"body","mesh":0})";
    const auto with = [&](const std::string& text) { return measure(load_box(replaced(kBox, node, text))); };

    const SurfaceProperties moved = with(R"({"mesh":0,"translation":[1,2,3],"scale":[2,1,1]})");
    CHECK(moved.volume == Approx(0.048));
    CHECK(length(moved.centroid - Vec3d(1, 2, 3)) < 1e-6);

    const SurfaceProperties turned = with(R"({"mesh":0,"rotation":[0,0,0.70710678,0.70710678]})");
    CHECK(turned.high.x == Approx(0.15));
    CHECK(turned.high.y == Approx(0.2));

    const SurfaceProperties mirrored = with(R"({"mesh":0,"scale":[-1,1,1],"translation":[1,0,0]})");
    CHECK(mirrored.volume == Approx(0.024));
    const SurfaceProperties matrix = with(R"({"mesh":0,"matrix":[0,1,0,0, 1,0,0,0, 0,0,1,0, 5,6,7,1]})");
    CHECK(matrix.volume == Approx(0.024));  // a mirror too: x and y change places
    CHECK(matrix.high.y == Approx(6.2));
    const SurfaceProperties child = with(R"({"children":[1],"scale":[2,2,2]},{"mesh":0,"translation":[1,0,0]})");
    CHECK(child.volume == Approx(0.192));
    CHECK(child.centroid.x == Approx(2));
}

TEST_CASE("all meshes of the scene are merged, and only those", "[gltf]") {
    const std::string nodes = R"("nodes":[{"name":"body","mesh":0}])";
    const std::string three =
        R"("nodes":[{"mesh":0},{"mesh":0,"translation":[2,0,0]},{"mesh":0,"translation":[4,0,0]}])";
    const std::string all = replaced(kBox, nodes, three);
    CHECK(load_box(all).triangles.size() == 12);
    CHECK(load_box(replaced(all, R"("scenes":[{"nodes":[0]}])", R"("scenes":[{"nodes":[0,2]}])")).triangles.size() ==
          24);
    CHECK(load_box(replaced(all, R"("scene":0,)", "")).triangles.size() == 36);
    CHECK(repair(load_box(replaced(all, R"("scene":0,)", "")), "x").shells == 3);
}

TEST_CASE("every way of writing triangles", "[gltf]") {
    // A tetrahedron as a strip, as two fans, and without indices; 8 and 32 bit indices; quantised; sparse.
    const auto file = [](const std::string& accessors, const std::string& primitives, std::string data, int positions) {
        const std::string size = std::to_string(data.size());
        return load_gltf(
            write("ways.glb",
                  glb(R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[)" + primitives +
                          R"(]}],"accessors":[)" + accessors + R"(],"bufferViews":[{"buffer":0,"byteLength":)" +
                          std::to_string(positions) + R"(},{"buffer":0,"byteOffset":)" + std::to_string(positions) +
                          R"(,"byteLength":)" + std::to_string(data.size() - static_cast<std::size_t>(positions)) +
                          R"(}],"buffers":[{"byteLength":)" + size + "}]}",
                      data)));
    };
    const float corners[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    std::string positions;
    for (const auto& corner : corners) {
        for (const float x : corner) put(positions, x);
    }
    const std::string vec3 = R"({"bufferView":0,"componentType":5126,"count":4,"type":"VEC3"},)";

    // Strip 0 2 1 3 0 2: (0,2,1) (2,3,1) (1,3,0) (3,2,0).
    std::string strip = positions;
    for (const std::uint32_t i : {0u, 2u, 1u, 3u, 0u, 2u}) put(strip, i);
    const Surface a = file(vec3 + R"({"bufferView":1,"componentType":5125,"count":6,"type":"SCALAR"})",
                           R"({"attributes":{"POSITION":0},"indices":1,"mode":5})", strip, 48);
    CHECK(a.triangles.size() == 4);
    CHECK(measure(a).volume == Approx(1.0 / 6));

    // Fan 0: (0,2,1) (0,1,3) (0,3,2), and the triangle across.
    const std::string fan = positions + std::string("\0\2\1\3\2\1\2\3", 8);
    const Surface b = file(
        vec3 + R"({"bufferView":1,"componentType":5121,"count":5,"type":"SCALAR"},)"
               R"({"bufferView":1,"byteOffset":5,"componentType":5121,"count":3,"type":"SCALAR"})",
        R"({"attributes":{"POSITION":0},"indices":1,"mode":6},{"attributes":{"POSITION":0},"indices":2})", fan, 48);
    CHECK(measure(b).volume == Approx(1.0 / 6));

    std::string plain;
    for (const int i : {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}) {
        for (const float x : corners[i]) put(plain, x);
    }
    const Surface c = file(R"({"bufferView":0,"componentType":5126,"count":12,"type":"VEC3"})",
                           R"({"attributes":{"POSITION":0}})", plain + "....", 144);
    CHECK(measure(c).volume == Approx(1.0 / 6));

    std::string quantised;
    for (const auto& corner : corners) {
        for (const float x : corner) put(quantised, static_cast<std::int16_t>(x * 32767));
        put(quantised, std::int16_t{0});
    }
    const std::string quantised_json =
        R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_mesh_quantization"],"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
        "accessors":[{"bufferView":0,"componentType":5122,"normalized":true,"count":4,"type":"VEC3"},{"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}],
        "bufferViews":[{"buffer":0,"byteLength":32,"byteStride":8},{"buffer":0,"byteOffset":32,"byteLength":12}],"buffers":[{"byteLength":44}]})";
    const std::string indices("\0\2\1\0\1\3\0\3\2\1\2\3", 12);
    CHECK(measure(load_gltf(write("quantised.glb", glb(quantised_json, quantised + indices)))).volume ==
          Approx(1.0 / 6));

    // All zero but for three vertices that a sparse accessor moves.
    const std::string sparse_json =
        R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
        "accessors":[{"componentType":5126,"count":4,"type":"VEC3","sparse":{"count":3,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":0,"byteOffset":12}}},
        {"bufferView":1,"componentType":5121,"count":12,"type":"SCALAR"}],
        "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":3}],"buffers":[{"byteLength":63}]})";
    CHECK(measure(load_gltf(write("sparse.glb", glb(sparse_json, positions + indices + "\1\2\3")))).volume ==
          Approx(1.0 / 6));
    const std::string past = write("sparse_past.glb", glb(sparse_json, positions + indices + "\1\2\4"));
    CHECK(error_of([&] { load_gltf(past); }).find("sparse") != std::string::npos);
}

TEST_CASE("broken glTF files are refused, naming what is wrong", "[gltf]") {
    struct Case {
        const char *from, *to, *named;
    };
    const Case cases[] = {
        {"\"version\":\"2.0\"", "\"version\":\"1.0\"", "version \"1.0\""},
        {"\"asset\":{\"version\":\"2.0\"},", "", "asset"},
        {"\"scene\":0", "\"scene\":3", "scene 3"},
        {"\"scenes\":[{\"nodes\":[0]}]", "\"scenes\":[{\"nodes\":[]}]", "scene 0"},
        {"\"scenes\":[{\"nodes\":[0]}]", "\"scenes\":[{\"nodes\":[7]}]", "node 7"},
        {"\"scenes\":[{\"nodes\":[0]}]", "\"scenes\":[{\"nodes\":[-1]}]", "node -1"},
        {"\"scenes\":[{\"nodes\":[0]}]", "\"scenes\":[{\"nodes\":[0,0]}]", "listed twice"},
        {"\"mesh\":0}", "\"mesh\":4}", "mesh 4"},
        {"\"mesh\":0}", "\"mesh\":0,\"children\":[0]}", "node \"body\""},
        {"\"mesh\":0}", "\"mesh\":0,\"children\":[9]}", "node 9"},
        {"\"mesh\":0}", "\"mesh\":0},{\"children\":[2]},{\"children\":[1]}", "circle"},
        {"\"mesh\":0}", "\"mesh\":0},{\"children\":[3]},{\"children\":[3]},{}", "two parents"},
        {"\"mesh\":0}", "\"mesh\":0},{\"children\":[0]}", "is a child of"},
        {"\"mesh\":0}", "\"mesh\":0,\"scale\":[1,0,1]}", "node \"body\""},
        {"\"mesh\":0}", "\"mesh\":0,\"scale\":[1,1]}", "wrong length"},
        {"\"mesh\":0}", "\"mesh\":0,\"translation\":[1e300,0,0]}", "far away"},
        {"\"mesh\":0}", "\"mesh\":0,\"rotation\":[0,0,0,0]}", "unit quaternion"},
        {"\"mesh\":0}", "\"mesh\":0,\"matrix\":[1,0,0,0,0,1,0,0,0,0,0,0,0,0,0,1]}", "flattens"},
        {"\"mesh\":0}", "\"mesh\":0,\"matrix\":[1,0,0,1,0,1,0,0,0,0,1,0,0,0,0,1]}", "projection"},
        {"\"mesh\":0}", "\"mesh\":0,\"skin\":0}", "skeleton"},
        {"\"mesh\":0}", "\"mesh\":0,\"scale\":[1e4,1e4,1e4]}", "metres"},
        {"\"mesh\":0}", "\"mesh\":0,\"scale\":[1e-3,1e-3,1e-3]}", "metres"},
        {"\"POSITION\":0", "\"NORMAL\":0", "mesh \"hull\", primitive 0: has no POSITION"},
        {"\"POSITION\":0", "\"POSITION\":12", "accessor 12"},
        {"\"POSITION\":0", "\"POSITION\":-2", "accessor -2"},
        {"\"POSITION\":0", "\"POSITION\":1", "accessor 1"},
        {"\"indices\":1", "\"indices\":5", "indices"},
        {"\"indices\":1", "\"indices\":0", "accessor 0"},
        {"\"indices\":1", "\"indices\":-3", "accessor -3"},
        {"\"mode\":4", "\"mode\":0", "points or lines"},
        {"\"mode\":4", "\"mode\":3", "points or lines"},
        {"\"mode\":4", "\"mode\":9", "primitive 0"},
        {"\"count\":8", "\"count\":0", "accessor 0"},
        {"\"count\":8", "\"count\":9", "bufferView 0"},
        {"\"count\":8", "\"count\":7", "accessor 1: index 7"},
        {"\"count\":8", "\"count\":18446744073709551615", "accessor 0"},
        {"\"count\":36", "\"count\":35", "no whole triangles"},
        {"\"count\":36", "\"count\":37", "bufferView 1"},
        {"\"bufferView\":0", "\"bufferView\":8", "bufferView 8"},
        {"\"bufferView\":0,", "", "no bufferView"},
        {"\"bufferView\":0,", "\"bufferView\":0,\"byteOffset\":4,", "bufferView 0"},
        {"\"bufferView\":0,", "\"bufferView\":0,\"byteOffset\":2,", "aligned"},
        {"\"bufferView\":0,", "\"bufferView\":0,\"byteOffset\":18446744073709551612,", "bufferView 0"},
        {"\"componentType\":5126", "\"componentType\":5125", "component type 5125"},
        {"\"componentType\":5126", "\"componentType\":77", "componentType"},
        {"\"componentType\":5123", "\"componentType\":5122", "accessor 1"},
        {"\"componentType\":5123", "\"componentType\":5125", "bufferView 1"},
        {"\"VEC3\"", "\"VEC2\"", "VEC3"},
        {"\"SCALAR\"", "\"VEC9\"", "type"},
        {"\"byteLength\":96", "\"byteLength\":95", "bufferView 0"},
        {"\"byteLength\":96", "\"byteLength\":999", "past the end of buffer 0"},
        {"\"byteLength\":96", "\"byteLength\":96,\"byteStride\":8", "byteStride 8"},
        {"\"byteLength\":96", "\"byteLength\":96,\"byteStride\":16", "bufferView 0"},
        {"\"byteLength\":96", "\"byteLength\":96,\"byteStride\":400", "byteStride"},
        {"\"byteOffset\":96", "\"byteOffset\":18446744073709551600", "past the end of buffer 0"},
        {"\"buffer\":0", "\"buffer\":1", "buffer 1"},
        {"\"buffer\":0", "\"buffer\":-1", "buffer -1"},
        {"\"byteLength\":168", "\"byteLength\":500", "glTF"},
        {"\"uri\":\"box.bin\"", "\"uri\":\"gone.bin\"", "gone.bin"},
        {"\"uri\":\"box.bin\"", "\"uri\":\"../../../../../../../etc/gone.bin\"", "gone.bin"},
        {"\"buffers\":[", "\"buffers\":{", "glTF"},
        {"\"buffers\"", "\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"buffers\"", "without compression"},
        {"\"buffers\"", "\"extensionsRequired\":[\"EXT_meshopt_compression\"],\"buffers\"", "gltf-transform"},
        {"\"buffers\"", "\"extensionsRequired\":[\"VENDOR_secret\"],\"buffers\"", "VENDOR_secret"},
        {"\"meshes\":[", "\"meshes\":[3,", "meshes"},
        {"\"mode\":4", "\"mode\":4,\"targets\":[{\"POSITION\":0}]}],\"weights\":[0.5],\"extras\":[{\"a\":1", "morph"},
    };
    for (const Case& c : cases) {
        INFO(c.from << " -> " << c.to);
        const std::string json = replaced(kBox, c.from, c.to);
        const std::string error = error_of([&] { load_box(json); });
        INFO(error);
        CHECK(error.find((folder() / "box.gltf").string()) == 0);
        CHECK(error.find(c.named) != std::string::npos);
    }
}

TEST_CASE("files that are no glTF at all", "[gltf]") {
    const auto error = [](const std::string& name, const std::string& content) {
        const std::string path = write(name, content);
        const std::string text = error_of([&] { load_gltf(path); });
        CHECK(text.find(path + ": ") == 0);
        return text;
    };
    const auto has = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
    CHECK(has(error("empty.glb", ""), "empty"));
    CHECK(has(error("mesh.obj", "v 0 0 0\nv 1 0 0\n"), "neither .glb nor .gltf"));
    CHECK(has(error("cut.gltf", kBox.substr(0, 300)), "not valid glTF"));
    CHECK(has(error("array.gltf", "[1, 2, 3]"), "glTF"));
    CHECK(has(error("bare.gltf", "{}"), "glTF"));
    CHECK(has(error("nothing.gltf", R"({"asset":{"version":"2.0"}})"), "no nodes"));
    CHECK(has(error("deep.gltf", R"({"asset":{"version":"2.0","extras":)" + std::string(200000, '[')), "nested"));
    CHECK(has(error_of([] { load_gltf((folder() / "none.glb").string()); }), "no such file"));
    CHECK(has(error_of([] { load_gltf(folder().string()); }), "not a file"));

    const std::string good = glb(replaced(kBox, R"("uri":"box.bin",)", ""), box_data());
    CHECK(has(error("short.glb", good.substr(0, 15)), "cut off"));
    CHECK(has(error("half.glb", good.substr(0, good.size() / 2)), "cut off"));
    std::string old = good;
    old[4] = 1;
    CHECK(has(error("old.glb", old), "version 1"));
    std::string longer = good;
    longer[12] = '\x7f';
    longer[13] = '\x7f';
    CHECK(has(error("chunk.glb", longer), "chunk 0"));
}

TEST_CASE("vertices that are no numbers", "[gltf]") {
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        std::string data = box_data();
        std::memcpy(&data[4 * 3 * 2], &bad, 4);
        const std::string path = write("nan.glb", glb(replaced(kBox, R"("uri":"box.bin",)", ""), data));
        CHECK(error_of([&] { load_gltf(path); }).find("accessor 0: vertex 2 is not a finite number") !=
              std::string::npos);
    }
}

TEST_CASE("a file with any few bytes changed loads or is refused", "[gltf]") {
    const std::string good = glb(replaced(kBox, R"("uri":"box.bin",)", ""), box_data());
    std::uint32_t random = 12345;
    const auto next = [&random](std::size_t below) {
        random = random * 1664525u + 1013904223u;
        return (random >> 8) % below;
    };
    int loaded = 0, refused = 0;
    for (int i = 0; i < 600; ++i) {
        std::string bytes = good;
        for (std::size_t n = next(4) + 1; n > 0; --n) bytes[next(bytes.size())] = static_cast<char>(next(256));
        if (i % 7 == 0) bytes.resize(next(bytes.size()));
        const std::string path = write("changed.glb", bytes);
        try {
            repair(load_gltf(path), path);
            ++loaded;
        } catch (const BakeError& e) {
            CHECK(std::string(e.what()).find(path + ": ") == 0);
            ++refused;
        }
    }
    CHECK(loaded > 0);
    CHECK(refused > 100);
}

TEST_CASE("repair leaves a good surface alone and joins seams", "[repair]") {
    const Surface sphere = test::icosphere(0.05, 2);
    const Repaired same = repair(sphere, "sphere");
    CHECK(same.notes.empty());
    CHECK(same.shells == 1);
    CHECK(same.surface.triangles == sphere.triangles);
    const Repaired seams = repair(unwelded(sphere), "sphere");
    CHECK(seams.notes.empty());
    CHECK(seams.surface.vertices.size() == sphere.vertices.size());
    CHECK(measure(seams.surface).volume == Approx(measure(sphere).volume));

    // Gaps of a 20,000th of the size are closed too, and that is said.
    Surface gaps = unwelded(test::box({1, 1, 1}));
    for (std::size_t v = 0; v < gaps.vertices.size(); ++v) gaps.vertices[v].x += 5e-5 * static_cast<double>(v % 2);
    const Repaired closed = repair(gaps, "gaps");
    CHECK(closed.surface.vertices.size() == 8);
    CHECK(mentions(closed.notes, "joined vertices"));
}

TEST_CASE("repair turns triangles outward", "[repair]") {
    const Surface box = test::box({0.4, 0.3, 0.2});
    const Repaired inward = repair(inside_out(box), "box");
    CHECK(measure(inward.surface).volume == Approx(0.024));
    CHECK(mentions(inward.notes, "faced inward"));

    Surface mixed = box;
    for (const std::size_t t : {1u, 4u, 7u}) std::swap(mixed.triangles[t][0], mixed.triangles[t][2]);
    const Repaired turned = repair(mixed, "box");
    CHECK(measure(turned.surface).volume == Approx(0.024));
    CHECK(mentions(turned.notes, "turned 3 triangles"));
}

TEST_CASE("repair drops what has no area and what is there twice", "[repair]") {
    Surface box = test::box({0.4, 0.3, 0.2});
    box.triangles.push_back({0, 0, 1});
    box.triangles.push_back(box.triangles[3]);
    const Repaired once = repair(box, "box");
    CHECK(once.surface.triangles.size() == 12);
    CHECK(mentions(once.notes, "1 triangle without area"));
    CHECK(mentions(once.notes, "1 repeated triangle"));

    // Faces for both sides: the whole box twice, once inside out.
    const Repaired both = repair(joined(test::box({1, 1, 1}), inside_out(test::box({1, 1, 1}))), "box");
    CHECK(both.surface.triangles.size() == 12);
    CHECK(measure(both.surface).volume == Approx(1));

    // A corner in the middle of another triangle's side: flat triangle (0, 8, 1) fills the T-junction.
    Surface junction = test::box({1, 1, 1});
    junction.vertices.push_back((junction.vertices[0] + junction.vertices[1]) * 0.5);
    for (std::size_t t = 0; t < 12; ++t) {
        Triangle& c = junction.triangles[t];
        for (std::size_t i = 0; i < 3; ++i) {
            if (c[i] == 0 && c[(i + 1) % 3] == 1) {
                const Triangle rest = {8, 1, c[(i + 2) % 3]};
                c = {0, 8, c[(i + 2) % 3]};
                junction.triangles.push_back(rest);
                junction.triangles.push_back({0, 1, 8});
                t = 12;
                break;
            }
        }
    }
    const Repaired flat = repair(junction, "box");
    CHECK(measure(flat.surface).volume == Approx(1));
    for (std::size_t t = 0; t < flat.surface.triangles.size(); ++t) {
        const Vec3d a = flat.surface.corner(t, 0);
        CHECK(length(cross(flat.surface.corner(t, 1) - a, flat.surface.corner(t, 2) - a)) > 0.1);
    }
}

TEST_CASE("several pieces", "[repair]") {
    const Surface box = test::box({1, 1, 1});
    // Apart, overlapping and touching along an edge: kept as they are.
    for (const Vec3d& by : {Vec3d(3, 0, 0), Vec3d(0.5, 0.3, 0.2), Vec3d(1, 1, 0)}) {
        const Repaired two = repair(joined(box, test::moved(box, by)), "two");
        CHECK(two.shells == 2);
        CHECK(measure(two.surface).volume == Approx(2));
        CHECK_NOTHROW(find_neighbours(two.surface, "test"));
    }
    // Sharing a face: the wall between them goes.
    const Repaired wall = repair(joined(box, test::moved(box, {1, 0, 0})), "two");
    CHECK(wall.shells == 1);
    CHECK(wall.surface.triangles.size() == 20);
    CHECK(mentions(wall.notes, "back to back"));
    // One in the other, whichever way round: no water reaches it.
    const Surface inner = test::icosphere(0.3, 2);
    for (const Surface& nested : {joined(inner, box), joined(box, inside_out(inner))}) {
        const Repaired one = repair(nested, "nested");
        CHECK(one.shells == 1);
        CHECK(measure(one.surface).volume == Approx(1));
        CHECK(mentions(one.notes, "inside another"));
    }
}

TEST_CASE("what cannot be baked is refused", "[repair]") {
    const auto has = [](const std::string& text, const char* part) {
        INFO(text);
        CHECK(text.find("thing: ") == 0);
        CHECK(text.find(part) != std::string::npos);
    };
    const auto refusal = [](const Surface& s) { return error_of([&] { repair(s, "thing"); }); };

    Surface open = test::box({0.4, 0.3, 0.2});
    open.triangles.resize(10);  // no lid at +z
    has(refusal(open), "open: 4 boundary edges");
    has(refusal(open), "0.1) m");
    has(refusal(unwelded(open)), "open: 4 boundary edges");

    Surface sheet;
    sheet.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
    has(refusal(sheet), "flat sheet");
    has(refusal(joined(sheet, inside_out(sheet))), "flat sheet");
    has(refusal(test::box({1, 1, 1e-6})), "flat sheet");

    Surface fin = test::box({1, 1, 1});
    fin.vertices.push_back({0, 0, 3});
    fin.triangles.push_back({4, 5, 8});
    has(refusal(fin), "open: 2 boundary edges");

    // A Klein bottle: a torus grid glued with a flip.
    Surface klein;
    constexpr std::uint32_t n = 8;
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < n; ++j)
            klein.vertices.push_back({std::sin(i * 0.9) + j * 0.01, std::cos(j * 0.9) + i * 0.02, i * j * 0.05});
    }
    const auto at = [](std::uint32_t i, std::uint32_t j) { return i < n ? i * n + j % n : (n - j % n) % n; };
    for (std::uint32_t i = 0; i < n; ++i) {
        for (std::uint32_t j = 0; j < n; ++j) {
            klein.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            klein.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    }
    has(refusal(klein), "only one side");

    has(refusal(Surface{}), "no triangles");
    Surface wild = test::box({1, 1, 1});
    wild.triangles[3][1] = 99;
    has(refusal(wild), "does not exist");
    Surface point;
    point.vertices = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}};
    point.triangles = {{0, 1, 2}};
    has(refusal(point), "one point");
}

TEST_CASE("the sample meshes need no repair", "[mesh][samples]") {
    struct Sample {
        const char* name;
        double volume, tolerance;
    };
    for (const Sample& s : {Sample{"box", 0.024, 1e-6},
                            {"plate", 0.00024, 1e-6},
                            {"sphere", 4.0 / 3 * kPi * 1.25e-4, 0.02},
                            {"paddle", 0.00155, 0.05},
                            {"canoe", 0.161, 0.05}}) {
        INFO(s.name);
        const Repaired r = repair(load_gltf(test::sample_path(std::string(s.name) + ".glb")), s.name);
        CHECK(r.notes.empty());
        CHECK(r.shells == 1);
        CHECK(measure(r.surface).volume == Approx(s.volume).epsilon(s.tolerance));
    }
    const Surface paddle = load_gltf(test::sample_path("paddle.glb"));
    const SurfaceProperties p = measure(paddle);
    CHECK(p.high.z - p.low.z == Approx(1.4).epsilon(0.02));
    CHECK(p.high.x - p.low.x == Approx(0.2).epsilon(0.01));
    CHECK(-p.low.z > p.high.z);                                                        // the blade is at -z
    CHECK(projected_area(paddle, {0, 1, 0}) > 2 * projected_area(paddle, {1, 0, 0}));  // and faces y
}

TEST_CASE("roundness tells a sphere from a box", "[mesh]") {
    CHECK(roundness(test::icosphere(1, 3)) == Approx(1));
    CHECK(roundness(test::box({1, 2, 3})) == Approx(0).margin(1e-9));
    // Its side turns by 2 pi over a height of 1, its two rims by half pi over pi each.
    constexpr double pi = 3.14159265358979323846;
    CHECK(roundness(test::cylinder(0.5, 1, 64)) == Approx(2 * pi / (2 * pi + pi * pi)).epsilon(0.01));
}
