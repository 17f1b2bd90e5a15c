// The meshes of samples/, as a bake takes them.
#pragma once

#include <filesystem>
#include <string>

#include "bake/mesh/gltf.h"
#include "bake/mesh/repair.h"

namespace frm::test {

inline std::string sample_path(const std::string& name) {
    return (std::filesystem::path(__FILE__).parent_path() / "../../samples/meshes" / name).string();
}

inline bake::Surface sample(const std::string& name) {
    return bake::repair(bake::load_gltf(sample_path(name)), name).surface;
}

}  // namespace frm::test
