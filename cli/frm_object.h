// The run-time library as the commands use it: through include/frm.h, with failures as exceptions.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "frm.h"

namespace frm::cli {

class Session {
public:
    Session();
    ~Session();
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    frm_context context() const { return context_; }
    /// Throws Failure with the library's own text, after `where` if that is given.
    void check(frm_status status, const std::string& where = "") const;
    std::string last_error() const;

    frm_map open_map(const std::string& path) const;
    frm_map_info map_info(frm_map map) const;
    std::string provenance(frm_map map) const;

private:
    frm_context context_ = 0;
};

nlohmann::ordered_json json_of(const frm_vec3& v);
nlohmann::ordered_json json_of(const frm_map_info& info);
/// Null for 0, by which an error or a rate is not known.
inline nlohmann::ordered_json if_known(double v) {
    return v > 0 ? nlohmann::ordered_json(v) : nlohmann::ordered_json();
}

}  // namespace frm::cli
