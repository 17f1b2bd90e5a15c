#include "bake/mesh/gltf_file.h"

#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <vector>

#include "bake/error.h"

namespace frm::bake {

namespace {

using Bytes = std::vector<unsigned char>;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;
// tinygltf reads `extras` recursively: text nested far deeper than any exporter writes would end the stack.
constexpr int kDeepestNesting = 64;

// Required extensions that do not change where the triangles are, or that gltf_data.cpp implements.
constexpr std::array kHarmlessPrefixes = {"KHR_materials_", "KHR_texture_", "EXT_texture_",
                                          "MSFT_texture_",  "KHR_lights_",  "EXT_lights_",
                                          "KHR_xmp",        "ADOBE_",       "KHR_mesh_quantization"};

bool starts_with(const std::string& text, const std::string& prefix) {
    return text.compare(0, prefix.size(), prefix) == 0;
}

// False when the file is missing, no regular file, too large or cannot be read; `why` then says which.
bool read_file(const std::string& path, Bytes& bytes, std::string& why) {
    std::error_code error;
    if (!std::filesystem::exists(path, error)) {
        why = "no such file";
        return false;
    }
    if (!std::filesystem::is_regular_file(path, error)) {
        why = "not a file";
        return false;
    }
    const std::uintmax_t size = std::filesystem::file_size(path, error);
    if (error || size > kMostBytes) {
        why = error ? error.message() : "larger than 1 GiB; export the shape alone, without textures and animations";
        return false;
    }
    bytes.resize(static_cast<std::size_t>(size));
    std::ifstream file(path, std::ios::binary);
    if (!file || (size > 0 && !file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))) {
        why = "cannot be read (check its permissions)";
        return false;
    }
    return true;
}

// tinygltf searches the working directory too, and opens images. Only files in the mesh's own directory exist for it
// here, and no images: a missing picture is a warning to it, and pictures play no part in a bake.
struct Beside {
    std::string directory;
    std::vector<std::string> read;  // what was read there
};

bool exists_beside(const std::string& path, void* beside) {
    if (!starts_with(path, static_cast<const Beside*>(beside)->directory)) return false;
    std::string extension = std::filesystem::path(path).extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    for (const char* image : {".png", ".jpg", ".jpeg", ".webp", ".ktx", ".ktx2", ".dds", ".basis", ".bmp", ".gif"}) {
        if (extension == image) return false;
    }
    std::error_code error;
    return std::filesystem::is_regular_file(path, error);
}

std::string same_path(const std::string& path, void*) { return path; }

bool read_beside(Bytes* bytes, std::string* error, const std::string& path, void* beside) {
    std::string why;
    if (read_file(path, *bytes, why)) {
        static_cast<Beside*>(beside)->read.push_back(path);
        return true;
    }
    if (error) *error += path + ": " + why + "\n";
    return false;
}

bool ignore_image(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
    return true;
}

std::uint32_t little_endian(const Bytes& bytes, std::size_t at) {
    return static_cast<std::uint32_t>(bytes[at]) | static_cast<std::uint32_t>(bytes[at + 1]) << 8 |
           static_cast<std::uint32_t>(bytes[at + 2]) << 16 | static_cast<std::uint32_t>(bytes[at + 3]) << 24;
}

// tinygltf lets the second chunk run eight bytes past the end, so the container is checked here in full.
void check_container(const std::string& path, const Bytes& bytes) {
    if (bytes.size() < 20) fail_gltf(path, "", "the .glb file is cut off in its header; export or copy it again");
    const std::uint32_t version = little_endian(bytes, 4);
    if (version != 2) {
        fail_gltf(path, "",
                  "the .glb container is version " + std::to_string(version) + ", only 2 is read; export as glTF 2.0");
    }
    const std::uint64_t length = little_endian(bytes, 8);
    if (length > bytes.size()) {
        fail_gltf(path, "",
                  "the .glb file is cut off: its header says " + std::to_string(length) + " bytes, it has " +
                      std::to_string(bytes.size()) + "; export or copy it again");
    }
    for (std::uint64_t at = 12, chunk = 0; at + 8 <= length && chunk < 2; ++chunk) {
        const std::uint64_t end = at + 8 + little_endian(bytes, static_cast<std::size_t>(at));
        if (end > length) {
            fail_gltf(path, "chunk " + std::to_string(chunk),
                      "reaches past the end of the file; export or copy it again");
        }
        at = end;
    }
}

void check_nesting(const std::string& path, const unsigned char* text, std::size_t size) {
    int depth = 0;
    bool in_string = false;
    for (std::size_t i = 0; i < size; ++i) {
        const unsigned char c = text[i];
        if (in_string) {
            if (c == '\\') ++i;
            in_string = c != '"';
        } else if (c == '"') {
            in_string = true;
        } else if (c == '{' || c == '[') {
            if (++depth > kDeepestNesting)
                fail_gltf(path, "", "its JSON is nested too deep to be a mesh; export it again");
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
}

void check_extensions(const std::string& path, const tinygltf::Model& model) {
    for (const std::string& name : model.extensionsRequired) {
        const auto harmless = [&](const char* prefix) { return starts_with(name, prefix); };
        if (std::any_of(kHarmlessPrefixes.begin(), kHarmlessPrefixes.end(), harmless)) continue;
        const std::string element = "required extension " + quoted(name);
        if (name == "KHR_draco_mesh_compression") {
            fail_gltf(path, element,
                      "Draco compression is not read; export again without compression, or run: "
                      "gltf-transform copy in.glb out.glb (it decodes Draco)");
        }
        if (name == "EXT_meshopt_compression" || name == "KHR_meshopt_compression") {
            fail_gltf(path, element,
                      "meshopt compression is not read; export again without compression (gltfpack: without "
                      "-c), or run: gltf-transform copy in.glb out.glb");
        }
        fail_gltf(path, element, "is not understood here; export again without it");
    }
}

std::string tidy(std::string text) {
    std::replace(text.begin(), text.end(), '\n', ' ');
    if (text.size() > 300) text = text.substr(0, 300) + "...";
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

}  // namespace

std::string quoted(const std::string& name) {
    std::string text = "\"";
    for (const char c : name.substr(0, 60)) text += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
    return text + (name.size() > 60 ? "...\"" : "\"");
}

void fail_gltf(const std::string& path, const std::string& element, const std::string& text) {
    throw BakeError(path + ": " + (element.empty() ? "" : element + ": ") + text);
}

static std::shared_ptr<const tinygltf::Model> open_model(const std::string& path, std::vector<std::string>& files) {
    Bytes bytes;
    std::string why;
    if (!read_file(path, bytes, why)) fail_gltf(path, "", why);
    if (bytes.empty()) fail_gltf(path, "", "the file is empty; export it again");

    const bool binary = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
    if (binary) {
        check_container(path, bytes);
        check_nesting(path, bytes.data() + 20, std::min<std::size_t>(little_endian(bytes, 12), bytes.size() - 20));
    } else {
        const auto first = std::find_if(bytes.begin(), bytes.end(), [](unsigned char c) { return c > ' '; });
        const bool byte_order_mark = bytes.size() >= 3 && bytes[0] == 0xEF && bytes[1] == 0xBB && bytes[2] == 0xBF;
        if (first == bytes.end() || (*first != '{' && !byte_order_mark)) {
            fail_gltf(path, "", "is neither .glb nor .gltf; export the mesh as glTF 2.0");
        }
        check_nesting(path, bytes.data(), bytes.size());
    }

    const std::string directory = std::filesystem::absolute(path).parent_path().string();
    Beside beside{directory, {}};
    tinygltf::TinyGLTF loader;
    loader.SetImageLoader(ignore_image, nullptr);
    loader.SetFsCallbacks({exists_beside, same_path, read_beside, nullptr, &beside});

    const auto model = std::make_shared<tinygltf::Model>();
    const auto size = static_cast<unsigned int>(bytes.size());
    std::string error, warning;
    bool parsed = false;
    try {
        parsed = binary ? loader.LoadBinaryFromMemory(model.get(), &error, &warning, bytes.data(), size, directory)
                        : loader.LoadASCIIFromString(model.get(), &error, &warning,
                                                     reinterpret_cast<const char*>(bytes.data()), size, directory);
    } catch (const std::exception& e) {
        error = e.what();
    }

    // A version or extension that is not for us explains any error better than the error itself.
    const std::string& version = model->asset.version;
    if (!version.empty() && !starts_with(version, "2.")) {
        fail_gltf(path, "asset.version " + quoted(version),
                  "only glTF 2.0 is read; export as glTF 2.0, or run: "
                  "gltf-pipeline -i in.gltf -o out.glb");
    }
    check_extensions(path, *model);
    // tinygltf reports success with an error text when it has left out what it could not read.
    if (!parsed || !error.empty()) {
        const std::string text = tidy(error.empty() ? "cannot be parsed" : error);
        if (text.find("File not found") != std::string::npos || text.find("no such file") != std::string::npos) {
            fail_gltf(path, "buffers",
                      text + ". The file's data must lie beside it: copy it there, or export as one .glb");
        }
        fail_gltf(path, "", "is not valid glTF: " + text + ". Export it again, or see what a glTF validator says");
    }
    files.push_back(path);
    files.insert(files.end(), beside.read.begin(), beside.read.end());
    return model;
}

std::shared_ptr<const tinygltf::Model> open_gltf(const std::string& path) {
    std::vector<std::string> files;
    return open_model(path, files);
}

std::vector<std::string> files_of_gltf(const std::string& path) {
    std::vector<std::string> files;
    open_model(path, files);
    return files;
}

}  // namespace frm::bake
