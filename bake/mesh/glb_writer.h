// Surfaces written as a binary glTF 2.0 file.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "bake/mesh/surface.h"

namespace frm::bake {

struct GlbPart {
    std::string name;                          ///< of its node and mesh
    std::array<double, 4> colour{1, 1, 1, 1};  ///< linear red, green, blue, opacity, 0 to 1
    const Surface* surface = nullptr;          ///< in metres; must outlive the call
};

/// The bytes of a .glb: a node for each part, without normals (a viewer then shades each triangle flat). Coordinates
/// become single precision. Parts without triangles are left out; at least one must have some. `generator` is stored in
/// the file as the program that made it. Throws BakeError for coordinates that are no finite floats, and for more than
/// glTF's 4 GiB.
std::string write_glb(const std::vector<GlbPart>& parts, const std::string& generator);

}  // namespace frm::bake
