// From the bytes of a .glb or .gltf file to tinygltf's model: all that can be wrong before geometry is looked at.
#pragma once

#include <memory>
#include <string>
#include <vector>

namespace tinygltf {
class Model;
}

namespace frm::bake {

/// A name from the file in quotes, for an error message: cut short, control characters removed.
std::string quoted(const std::string& name);

/// Throws BakeError: "path: element: text". `element` may be empty.
[[noreturn]] void fail_gltf(const std::string& path, const std::string& element, const std::string& text);

/// Reads and parses the file and its buffers, never its images. Throws BakeError when it is not glTF 2.0, is cut off,
/// needs an extension that is not understood here, or when a buffer is missing.
std::shared_ptr<const tinygltf::Model> open_gltf(const std::string& path);

/// The files that open_gltf reads: `path` itself first, then those of its buffers that lie in files of their own.
std::vector<std::string> files_of_gltf(const std::string& path);

}  // namespace frm::bake
