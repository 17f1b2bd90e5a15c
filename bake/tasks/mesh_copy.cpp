#include "bake/tasks/mesh_copy.h"

#include <filesystem>

#include "bake/mesh/gltf_file.h"
#include "bake/tasks/durable.h"

namespace frm::bake {

void copy_mesh(const std::string& mesh, const std::string& folder) {
    namespace fs = std::filesystem;
    constexpr std::uint64_t most = std::uint64_t{1} << 30;  // what open_gltf takes
    const fs::path beside = fs::absolute(mesh).parent_path();
    for (const std::string& file : files_of_gltf(mesh)) {
        const fs::path name = fs::absolute(file).lexically_normal().lexically_relative(beside.lexically_normal());
        if (name.empty() || *name.begin() == "..")
            throw FileError(file + ": lies outside the folder of " + mesh +
                            "; put it beside the mesh, or export the mesh as one .glb");
        std::vector<std::uint8_t> bytes, there;
        if (!read_whole(file, most, bytes)) throw FileError(file + ": has gone");
        const std::string copy = mesh_in(folder, name.string());
        if (read_whole(copy, most, there) && there == bytes) continue;
        make_folders(fs::path(copy).parent_path().string());
        write_durably(copy, bytes.data(), bytes.size());
    }
}

}  // namespace frm::bake
