#include "bake/report_json.h"

#include <algorithm>
#include <limits>

#include "bake/regions/region_error.h"

namespace frm::bake {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* format = "frm bake summary 1";
constexpr double none = std::numeric_limits<double>::quiet_NaN();  // null

/// Zero is no budget.
double asked(double budget) { return budget > 0 ? budget : none; }

}  // namespace

Json errors_json(const BakePlan& plan, const Map& map, const BakeReport& report) {
    const RegionErrors regions = RegionJudge(plan.surface).measure(plan.regions);
    // A single flow, all round by symmetry, has no others to be predicted from.
    const DirectionErrors& between = report.direction_errors;
    const bool known = std::any_of(report.flows.begin(), report.flows.end(),
                                   [](const BakeReport::Flow& flow) { return flow.left_out >= 0; });
    Json j;
    j["errors"] = {{"direction_rms", known ? between.rms : none},
                   {"direction_worst", known ? between.worst : none},
                   {"rounding", map.facts.quantisation_error},
                   {"uncertainty", report.uncertainty},
                   {"added_mass", map.has_added_mass ? report.added_mass_error : none},
                   {"regions", regions.whole},
                   {"wet_ratio", regions.wet_ratio},
                   {"velocity", regions.velocity},
                   {"arm", regions.arm}};
    j["budgets"] = {{"direction_rms", asked(plan.budget.rms)},
                    {"direction_worst", asked(plan.budget.worst)},
                    {"rounding", kRoundingBudget},
                    {"uncertainty", kNotedUncertainty},
                    {"regions", plan.options.sources ? none : region_error_of(plan.options.quality)}};
    return j;
}

std::string report_text(const BakePlan& plan, const Map& map, const BakeReport& report) {
    Json j{{"format", format}, {"mesh_hash", plan.mesh_hash}, {"notes", plan.notes}};
    j.update(errors_json(plan, map, report));
    for (std::size_t k = 0; k < report.flows.size(); ++k) {
        const BakeReport::Flow& flow = report.flows[k];
        const bool spin = plan.tasks[k].kind == TaskKind::spin;
        j["flows"].push_back({{"name", flow.name},
                              {"kind", spin ? "spin" : "stream"},
                              {"direction", {flow.direction.x, flow.direction.y, flow.direction.z}},
                              {"speed", flow.speed},
                              {"cd", spin ? none : flow.drag_coefficient},
                              {"uncertainty", flow.uncertainty},
                              {"left_out", flow.left_out < 0 ? none : flow.left_out}});
    }
    // A file's name may hold bytes that are not UTF-8.
    return j.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace frm::bake
