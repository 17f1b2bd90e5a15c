// Loads the shape of a glTF 2.0 file as one triangle soup, in metres. repair.h makes a closed surface of it.
#pragma once

#include <string>

#include "bake/error.h"
#include "bake/mesh/surface.h"

namespace frm::bake {

/// Reads a .glb or .gltf file: all meshes of its default scene (of all root nodes where it names none), node transforms
/// applied, mirrored ones with their winding turned round. Materials, textures, animations, cameras and lights are not
/// looked at.
///
/// The result is what the file says, not yet fit for a bake: seams are unwelded and it may be open. Throws BakeError
/// for every file that is broken, is not a rigid triangle shape, has more than two million triangles, or is larger than
/// a kilometre or smaller than a millimetre, after everything was multiplied by `scale` about the origin. The error's
/// text starts with `path`, names the element and says what to do.
Surface load_gltf(const std::string& path, double scale = 1);

/// The longest side of the shape's bounding box as the file has it, in its metres, however large or small.
double extent_of_gltf(const std::string& path);

}  // namespace frm::bake
