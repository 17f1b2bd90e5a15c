// The mesh in a folder that goes to other machines.
#pragma once

#include <string>

namespace frm::bake {

/// Copies the mesh file, and the files of its buffers, to FOLDER/mesh. Throws FileError where a buffer lies outside the
/// mesh's folder.
void copy_mesh(const std::string& mesh, const std::string& folder);

/// Where copy_mesh() puts a mesh of this name.
inline std::string mesh_in(const std::string& folder, const std::string& name) { return folder + "/mesh/" + name; }

}  // namespace frm::bake
