#include "cli/scene.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "cli/command.h"
#include "cli/json_reader.h"
#include "cli/presets.h"

namespace frm::cli {
namespace {

using Json = nlohmann::json;

frm_world_def read_world(const JsonReader& j) {
    j.allow_only(
        {"model", "surface", "gravity", "density", "viscosity", "level", "skip", "error_budget", "time_budget"});
    frm_world_def def;
    frm_world_def_init(&def, sizeof def);
    j.choose("model", def.model,
             {{"default", FRM_MODEL_DEFAULT},
              {"paper", FRM_MODEL_PAPER},
              {"displacement", FRM_MODEL_DISPLACEMENT},
              {"own_waves", FRM_MODEL_OWN_WAVES},
              {"fluctuation", FRM_MODEL_FLUCTUATION},
              {"speeds", FRM_MODEL_SPEEDS},
              {"spin", FRM_MODEL_SPIN}});
    j.choose("surface", def.surface, {{"flat", FRM_SURFACE_FLAT}, {"none", FRM_SURFACE_NONE}});
    j.read("gravity", def.gravity);
    j.read("density", def.density);
    j.read("viscosity", def.viscosity);
    j.read("level", def.level);
    j.choose("skip", def.skip, {{"all", FRM_SKIP_DEFAULT}, {"nothing", FRM_SKIP_NOTHING}});
    j.read("error_budget", def.error_budget);
    j.read("time_budget", def.time_budget);
    return def;
}

frm_water_def read_water(const JsonReader& j) {
    j.allow_only({"nx", "ny", "cell", "depth", "border", "border_cells", "snapshot_interval", "centre", "order"});
    frm_water_def def;
    frm_water_def_init(&def, sizeof def);
    j.read("nx", def.nx);
    j.read("ny", def.ny);
    j.read("cell", def.cell);
    j.read("depth", def.depth);
    j.choose("border", def.border, {{"absorbing", FRM_BORDER_ABSORBING}, {"reflecting", FRM_BORDER_REFLECTING}});
    j.read("border_cells", def.border_cells);
    j.read("snapshot_interval", def.snapshot_interval);
    j.read("order", def.order);
    double centre[2] = {def.centre_x, def.centre_y};
    j.read("centre", centre);
    def.centre_x = centre[0];
    def.centre_y = centre[1];
    return def;
}

SceneBody read_body(const JsonReader& j) {
    j.allow_only({"name", "map", "scale", "mass", "centre_of_mass", "motion"});
    if (!j.has("motion")) j.fail("motion", "is missing");
    SceneBody body{"", "", j.where(), {}, Motion(j.object("motion"))};
    j.read("map", body.map);
    if (body.map.empty()) j.fail("map", "the name of a map is needed");
    body.name = body.map;
    j.read("name", body.name);
    if (body.name.empty() || body.name.find_first_of(",\"\r\n") != std::string::npos)
        j.fail("name", "a name without commas, quotation marks and line ends is needed");
    frm_body_def_init(&body.def, sizeof body.def);
    j.read("scale", body.def.scale);
    j.read("mass", body.def.mass);
    Numbers centre{};
    j.read("centre_of_mass", centre);
    body.def.centre_of_mass = {static_cast<float>(centre[0]), static_cast<float>(centre[1]),
                               static_cast<float>(centre[2])};
    if (body.motion.device().empty()) body.motion.at(0, body.def.pose, body.def.twist);
    return body;
}

/// The file's, unless another is asked for.
const Preset& read_preset(const JsonReader& j, const std::string& asked) {
    std::string name = "default";
    j.read("preset", name);
    if (!find_preset(name)) j.fail("preset", "\"" + name + "\" is not one of " + preset_names(", "));
    return *find_preset(asked.empty() ? name : asked);
}

Json parse(const std::string& path) {
    std::ifstream file(path);
    if (!file || std::filesystem::is_directory(path)) throw Failure(path + ": cannot be opened");
    try {
        return Json::parse(file, nullptr, true, true);
    } catch (const Json::exception& error) {
        const std::string text =
            error.what();  // "[json.exception.parse_error.101] parse error at line 3, column 5: ..."
        throw Failure(path + ": is not a scene: " + text.substr(text.find("] ") + 2));
    }
}

/// "name=path" from the command line.
void add_map(const std::string& text, std::map<std::string, std::string>& maps) {
    const std::size_t equals = text.find('=');
    if (equals == 0 || equals == std::string::npos || equals + 1 == text.size())
        throw Failure("--map " + text + ": name=FILE is needed");
    if (!maps.emplace(text.substr(0, equals), text.substr(equals + 1)).second)
        throw Failure("--map " + text + ": that name was given before");
}

}  // namespace

Scene read_scene(const std::string& path, const std::vector<std::string>& maps, const std::string& preset) {
    const Json root = parse(path);
    const JsonReader j(root, path);
    j.allow_only({"title", "dt", "seconds", "preset", "world", "water", "maps", "bodies"});
    Scene scene;
    scene.path = path;
    scene.title = std::filesystem::path(path).stem().string();
    j.read("title", scene.title);
    j.read("dt", scene.dt);
    j.read("seconds", scene.seconds);
    if (!(scene.dt >= 1e-6 && scene.dt <= 0.1)) j.fail("dt", "a number from 1e-6 to 0.1 is needed");
    if (!(scene.seconds > 0)) j.fail("seconds", "a number above 0 is needed");
    const Json none = Json::object();
    scene.world = read_world(j.has("world") ? j.object("world") : JsonReader(none, path + ".world"));
    if (j.has("water")) scene.water = read_water(j.object("water"));
    const Preset wanted = read_preset(j, preset);
    if (scene.water) apply_preset(wanted, *scene.water);

    for (const std::string& map : maps) add_map(map, scene.maps);
    const std::map<std::string, std::string> given = scene.maps;
    for (const auto& [name, file] : j.texts("maps"))
        scene.maps.emplace(name, (std::filesystem::path(path).parent_path() / file).string());
    for (const JsonReader& one : j.list("bodies")) {
        scene.bodies.push_back(read_body(one));
        const std::string& map = scene.bodies.back().map;
        if (!scene.maps.count(map))
            one.fail("map", "\"" + map + "\" is not in .maps; give it there or as --map " + map + "=FILE");
    }
    for (const auto& [name, file] : given)
        if (std::none_of(scene.bodies.begin(), scene.bodies.end(), [&](const auto& body) { return body.map == name; }))
            throw Failure("--map " + name + "=" + file + ": no body of " + path + " has a map of that name");
    return scene;
}

}  // namespace frm::cli
