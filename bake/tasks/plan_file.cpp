#include "bake/tasks/plan_file.h"

#include <nlohmann/json.hpp>

#include "bake/tasks/result_file.h"
#include "bake/tasks/version.h"
#include "core/map/bytes.h"
#include "core/math/hash.h"

namespace frm::bake {
namespace {

using Json = nlohmann::ordered_json;

constexpr int version = 1;

/// All options but the mesh's folder and `threads`, which the map does not depend on. The list of names ends
/// compilation when an option is added: it must join the others here and in options_of(), or two different bakes would
/// share their results.
Json json_of(const BakeOptions& o) {
    const auto& [mesh, scale, quality, speed, density, viscosity, speeds, spin, added_mass, symmetry, directions,
                 sources, resolution, triangles, threshold, threads] = o;
    static_cast<void>(threads);
    return {{"mesh", mesh.substr(mesh.find_last_of('/') + 1)},
            {"scale", scale},
            {"quality", name_of(quality)},
            {"speed", speed},
            {"density", density},
            {"viscosity", viscosity},
            {"speeds", speeds},
            {"spin", spin},
            {"added_mass", added_mass},
            {"symmetry", symmetry},
            {"directions", directions},
            {"sources", sources},
            {"resolution", resolution},
            {"triangles", triangles},
            {"threshold", threshold}};
}

BakeOptions options_of(const Json& j) {
    BakeOptions o;
    j.at("mesh").get_to(o.mesh);
    // A folder from elsewhere must not lead to files outside it.
    if (o.mesh.empty() || o.mesh == "." || o.mesh == ".." || o.mesh.find('/') != std::string::npos)
        throw BakeError("the mesh is not a file's name");
    o.quality = quality_of(j.at("quality").get<std::string>());
    j.at("scale").get_to(o.scale);
    j.at("speed").get_to(o.speed);
    j.at("density").get_to(o.density);
    j.at("viscosity").get_to(o.viscosity);
    j.at("speeds").get_to(o.speeds);
    j.at("spin").get_to(o.spin);
    j.at("added_mass").get_to(o.added_mass);
    j.at("symmetry").get_to(o.symmetry);
    j.at("directions").get_to(o.directions);
    j.at("sources").get_to(o.sources);
    j.at("resolution").get_to(o.resolution);
    j.at("triangles").get_to(o.triangles);
    j.at("threshold").get_to(o.threshold);
    // What is not known here, or is out of range, does not come back as it was.
    if (json_of(o) != j) throw BakeError("its options are not those of this version of frm");
    return o;
}

}  // namespace

std::string fingerprint_of(const BakePlan& plan) {
    std::vector<std::uint8_t> bytes;
    ByteWriter<std::vector<std::uint8_t>> w(bytes);
    const auto text = [&](const std::string& s) { w.u64(s.size()), w.bytes(s.data(), s.size()); };
    text(solver_version);
    text(json_of(plan.options).dump());
    text(plan.mesh_hash);
    for (const std::string& note : plan.notes) text(note);  // they go into the map
    for (const std::uint32_t region : plan.regions.region) w.u32(region);
    w.u32(plan.regions.count), w.u32(plan.directions.count()), w.u32(plan.harmonics), w.u32(plan.samples);
    for (const double v : {plan.reference_length, plan.start_up, plan.period, plan.overlap}) w.f64(v);
    const std::uint64_t body = hash_of_body(plan.surface, plan.patches);
    for (const Task& task : plan.tasks) w.u64(key_of(body, task.flow));
    return hash_text(fnv1a(bytes.data(), bytes.size()));
}

std::string plan_text(const BakePlan& plan, const std::string& fingerprint, std::size_t tasks) {
    const Json j{{"format", "frm bake plan"},  {"version", version}, {"solver", solver_version},
                 {"fingerprint", fingerprint}, {"tasks", tasks},     {"options", json_of(plan.options)}};
    return j.dump(2) + "\n";
}

bool is_somebody_elses(const std::string& text) {
    const Json j = Json::parse(text, nullptr, false);
    return !j.is_discarded() && !(j.is_object() && j.contains("format") && j["format"] == "frm bake plan");
}

PlanFile parse_plan(const std::string& text, const std::string& name) {
    PlanFile file;
    try {
        const Json j = Json::parse(text);
        if (j.at("format") != "frm bake plan") throw BakeError("it is something else");
        if (j.at("version") != version || j.at("solver") != solver_version)
            throw BakeError("another version of frm wrote it; plan again with this one");
        j.at("fingerprint").get_to(file.fingerprint);
        j.at("tasks").get_to(file.tasks);
        file.options = options_of(j.at("options"));
    } catch (const nlohmann::json::exception&) {
        throw BakeError(name + ": is not a plan of frm bake, or is damaged");
    } catch (const BakeError& error) {
        throw BakeError(name + ": is not a plan of frm bake for this program: " + error.what());
    }
    return file;
}

}  // namespace frm::bake
