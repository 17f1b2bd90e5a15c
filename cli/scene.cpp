#include "cli/scene.h"

#include <cmath>
#include <filesystem>
#include <fstream>

#include "cli/command.h"

namespace frm::cli {
namespace {

using Json = nlohmann::json;

void know(const Json& j, const std::string& where, const std::vector<std::string>& keys) {
    if (!j.is_object()) throw Failure(where + ": an object is needed");
    for (const auto& [key, ignored] : j.items()) {
        bool known = false;
        for (const std::string& k : keys) known |= k == key;
        if (!known) throw Failure(where + "." + key + ": not known here");
    }
}

double number(const Json& j, const char* key, double otherwise, const std::string& where) {
    if (!j.contains(key)) return otherwise;
    if (!j[key].is_number()) throw Failure(where + "." + key + ": a number is needed");
    return j[key].get<double>();
}

void read(const Json& j, const char* key, float& out, const std::string& where) {
    out = static_cast<float>(number(j, key, static_cast<double>(out), where));
}

void read(const Json& j, const char* key, double& out, const std::string& where) { out = number(j, key, out, where); }

void read(const Json& j, const char* key, std::uint32_t& out, const std::string& where) {
    const double v = number(j, key, out, where);
    if (!(v >= 0 && v <= 1e9) || v != std::floor(v)) throw Failure(where + "." + key + ": a whole number is needed");
    out = static_cast<std::uint32_t>(v);
}

std::string text(const Json& j, const char* key, const std::string& otherwise, const std::string& where) {
    if (!j.contains(key)) return otherwise;
    if (!j[key].is_string()) throw Failure(where + "." + key + ": a text is needed");
    return j[key].get<std::string>();
}

void choose(const Json& j, const char* key, std::uint32_t& out, const std::map<std::string, std::uint32_t>& choices, const std::string& where) {
    if (!j.contains(key)) return;
    const std::string word = text(j, key, "", where);
    const auto found = choices.find(word);
    std::string all;
    for (const auto& [name, ignored] : choices) all += (all.empty() ? "" : ", ") + name;
    if (found == choices.end()) throw Failure(where + "." + key + ": \"" + word + "\" is not one of " + all);
    out = found->second;
}

frm_vec3 vector(const Json& j, const char* key, const std::string& where) {
    if (!j.contains(key)) return {0, 0, 0};
    const Json& v = j[key];
    if (!v.is_array() || v.size() != 3 || !v[0].is_number() || !v[1].is_number() || !v[2].is_number())
        throw Failure(where + "." + key + ": three numbers are needed");
    return {v[0].get<float>(), v[1].get<float>(), v[2].get<float>()};
}

frm_world_def read_world(const Json& j, const std::string& where) {
    know(j, where, {"model", "surface", "gravity", "density", "viscosity", "level"});
    frm_world_def def;
    frm_world_def_init(&def, sizeof def);
    choose(j, "model", def.model,
           {{"default", FRM_MODEL_DEFAULT}, {"paper", FRM_MODEL_PAPER}, {"displacement", FRM_MODEL_DISPLACEMENT}, {"own_waves", FRM_MODEL_OWN_WAVES}}, where);
    choose(j, "surface", def.surface, {{"flat", FRM_SURFACE_FLAT}, {"none", FRM_SURFACE_NONE}}, where);
    read(j, "gravity", def.gravity, where);
    read(j, "density", def.density, where);
    read(j, "viscosity", def.viscosity, where);
    read(j, "level", def.level, where);
    return def;
}

frm_water_def read_water(const Json& j, const std::string& where) {
    know(j, where, {"nx", "ny", "cell", "depth", "border", "border_cells", "snapshot_interval", "centre"});
    frm_water_def def;
    frm_water_def_init(&def, sizeof def);
    read(j, "nx", def.nx, where);
    read(j, "ny", def.ny, where);
    read(j, "cell", def.cell, where);
    read(j, "depth", def.depth, where);
    choose(j, "border", def.border, {{"absorbing", FRM_BORDER_ABSORBING}, {"reflecting", FRM_BORDER_REFLECTING}}, where);
    read(j, "border_cells", def.border_cells, where);
    read(j, "snapshot_interval", def.snapshot_interval, where);
    if (j.contains("centre")) {
        const Json& c = j["centre"];
        if (!c.is_array() || c.size() != 2 || !c[0].is_number() || !c[1].is_number()) throw Failure(where + ".centre: two numbers are needed");
        def.centre_x = c[0].get<double>();
        def.centre_y = c[1].get<double>();
    }
    return def;
}

SceneBody read_body(const Json& j, const std::string& where) {
    know(j, where, {"name", "map", "scale", "mass", "centre_of_mass", "motion"});
    if (!j.contains("motion")) throw Failure(where + ".motion: is missing");
    SceneBody body{text(j, "name", "", where), text(j, "map", "", where), {}, Motion(j["motion"], where + ".motion")};
    if (body.map.empty()) throw Failure(where + ".map: the name of a map is needed");
    if (body.name.empty()) body.name = body.map;
    frm_body_def_init(&body.def, sizeof body.def);
    read(j, "scale", body.def.scale, where);
    read(j, "mass", body.def.mass, where);
    body.def.centre_of_mass = vector(j, "centre_of_mass", where);
    if (body.motion.device().empty()) body.motion.at(0, body.def.pose, body.def.twist);
    return body;
}

}  // namespace

Scene read_scene(const std::string& path, const std::vector<std::string>& maps) {
    std::ifstream file(path);
    if (!file) throw Failure(path + ": cannot be opened");
    Json j;
    try {
        j = Json::parse(file, nullptr, true, true);
    } catch (const Json::parse_error& error) {
        throw Failure(path + ": " + error.what());
    }
    know(j, path, {"title", "dt", "seconds", "world", "water", "maps", "bodies"});
    Scene scene;
    scene.title = text(j, "title", std::filesystem::path(path).stem().string(), path);
    read(j, "dt", scene.dt, path);
    read(j, "seconds", scene.seconds, path);
    require_positive(scene.dt, path + ".dt");
    require_positive(scene.seconds, path + ".seconds");
    scene.world = read_world(j.value("world", Json::object()), path + ".world");
    if (j.contains("water")) scene.water = read_water(j["water"], path + ".water");

    for (const std::string& map : maps) {
        const std::size_t equals = map.find('=');
        if (equals == 0 || equals == std::string::npos || equals + 1 == map.size()) throw Failure("--map " + map + ": name=path is needed");
        scene.maps[map.substr(0, equals)] = map.substr(equals + 1);
    }
    if (j.contains("maps")) {
        if (!j["maps"].is_object()) throw Failure(path + ".maps: an object is needed");
        for (const auto& [name, value] : j["maps"].items()) {
            const std::string file_name = text(j["maps"], name.c_str(), "", path + ".maps");
            const std::filesystem::path beside = std::filesystem::path(path).parent_path() / file_name;
            scene.maps.emplace(name, beside.string());
        }
    }
    if (!j.contains("bodies") || !j["bodies"].is_array()) throw Failure(path + ".bodies: a list is needed");
    for (const Json& body : j["bodies"]) {
        const std::string where = path + ".bodies[" + std::to_string(scene.bodies.size()) + "]";
        scene.bodies.push_back(read_body(body, where));
        if (!scene.maps.count(scene.bodies.back().map))
            throw Failure(where + ".map: \"" + scene.bodies.back().map + "\" is not in .maps; give it here or as --map " + scene.bodies.back().map + "=FILE");
    }
    return scene;
}

}  // namespace frm::cli
