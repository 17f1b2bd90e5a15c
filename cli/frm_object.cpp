#include "cli/frm_object.h"

#include "cli/command.h"
#include "core/math/hash.h"

namespace frm::cli {

Session::Session() {
    if (const frm_status status = frm_context_create(nullptr, &context_); status != FRM_OK)
        throw Failure(std::string("the library cannot start: ") + frm_status_name(status));
}

Session::~Session() { frm_context_destroy(context_); }

std::string Session::last_error() const {
    std::uint64_t size = 0;
    frm_context_last_error(context_, nullptr, 0, &size);
    std::string text(size, 0);
    frm_context_last_error(context_, text.data(), size, &size);
    if (!text.empty()) text.pop_back();
    return text;
}

void Session::check(frm_status status, const std::string& where) const {
    if (status != FRM_OK) throw Failure((where.empty() ? "" : where + ": ") + last_error());
}

frm_map Session::open_map(const std::string& path) const {
    frm_map map = 0;
    check(frm_map_open_file(context_, path.c_str(), &map));
    return map;
}

frm_map_info Session::map_info(frm_map map) const {
    frm_map_info info{};
    info.struct_size = sizeof info;
    check(frm_map_get_info(map, &info));
    return info;
}

std::string Session::provenance(frm_map map) const {
    std::uint64_t size = 0;
    check(frm_map_get_provenance(map, nullptr, 0, &size));
    std::string text(size, 0);
    check(frm_map_get_provenance(map, text.data(), size, &size));
    text.pop_back();
    return text;
}

nlohmann::ordered_json json_of(const frm_vec3& v) { return {v.x, v.y, v.z}; }

nlohmann::ordered_json json_of(const frm_map_info& info) {
    nlohmann::ordered_json j;
    j["format_version"] = info.format_version;
    j["file_bytes"] = info.file_bytes;
    j["content_hash"] = hash_text(info.content_hash);
    j["sources"] = info.sources;
    j["directions"] = info.directions;
    j["fluctuation_directions"] = info.fluctuation_directions;
    j["speeds"] = info.speeds;
    j["has_spin"] = info.has_spin != 0;
    j["has_added_mass"] = info.has_added_mass != 0;
    j["samples"] = info.samples;
    j["triangles"] = info.triangles;
    j["period"] = info.period;
    j["base_speed"] = info.base_speed;
    j["density"] = info.density;
    j["viscosity"] = info.viscosity;
    j["reynolds"] = info.reynolds;
    j["reynolds_solved"] = info.reynolds_solved;
    j["reference_length"] = info.reference_length;
    j["quantisation_error"] = info.quantisation_error;
    j["direction_error_rms"] = if_known(info.direction_error_rms);
    j["direction_error_worst"] = if_known(info.direction_error_worst);
    j["uncertainty"] = if_known(info.uncertainty);
    j["area"] = info.area;
    j["volume"] = info.volume;
    j["centroid"] = json_of(info.centroid);
    j["bounds_low"] = json_of(info.bounds_low);
    j["bounds_high"] = json_of(info.bounds_high);
    return j;
}

}  // namespace frm::cli
