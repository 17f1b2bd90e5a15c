// What a bake says of its map's errors, as JSON: the same for the program's report and for an editor.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "bake/bake.h"

namespace frm::bake {

/// "errors" and "budgets": shares; null where one is not known or not asked for.
nlohmann::ordered_json errors_json(const BakePlan& plan, const Map& map, const BakeReport& report);

/// These, the notes and what is known of each flow: what frm_bake_get_report gives.
std::string report_text(const BakePlan& plan, const Map& map, const BakeReport& report);

}  // namespace frm::bake
