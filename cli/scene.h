// A scene file: a world, its water, maps, and bodies with their motion. docs/scene.md is its manual.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/motion.h"
#include "frm.h"

namespace frm::cli {

struct SceneBody {
    std::string name, map;
    std::string where;   ///< in the file, for messages
    frm_body_def def{};  ///< without the map
    Motion motion;
};

struct Scene {
    std::string path, title;
    double dt = 0.002, seconds = 0;
    frm_world_def world{};
    std::optional<frm_water_def> water;
    std::map<std::string, std::string> maps;  ///< name to path
    std::vector<SceneBody> bodies;
};

/// Reads a scene. `maps` ("name=path") come before the file's own, whose paths are relative to the file; so does `preset`
/// (cli/presets.h), unless it is empty. Throws Failure naming the key that is wrong; keys that are not known are wrong.
Scene read_scene(const std::string& path, const std::vector<std::string>& maps, const std::string& preset = "");

}  // namespace frm::cli
