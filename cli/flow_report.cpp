#include "cli/flow_report.h"

#include "cli/file.h"
#include "cli/progress.h"
#include "cli/report.h"

namespace frm::cli {
namespace {

constexpr const char* page_name = "report.html";
constexpr const char* json_name = "flow.json";
constexpr const char* series_name = "series.csv";
constexpr const char* slices_name = "slices.f32";
constexpr const char* format = "frm flow report 1";

const ReportKind& kind() {
    static const ReportKind kind{{json_name, series_name, slices_name, page_name}, format};
    return kind;
}

/// The slices one after another, for each first the speeds and then the pressures, as little-endian float; and for the
/// JSON what each is and where it begins, in values.
std::string slices_of(const bake::FlowSeries& flow, nlohmann::ordered_json& list) {
    std::string bytes;
    list = nlohmann::ordered_json::array();
    for (const bake::FlowSlice& slice : flow.slices) {
        list.push_back({{"normal", slice.normal},
                        {"low", json_of(slice.low)},
                        {"spacing", slice.spacing},
                        {"columns", slice.columns},
                        {"rows", slice.rows},
                        {"offset", bytes.size() / sizeof(float)}});
        for (const std::vector<float>* values : {&slice.speed, &slice.pressure})
            bytes.append(reinterpret_cast<const char*>(values->data()), values->size() * sizeof(float));
    }
    return bytes;
}

nlohmann::ordered_json describe(const FlowSetting& setting, const bake::FlowSeries& flow, const FlowResults& results) {
    const bake::FlowCase& c = setting.flow;
    nlohmann::ordered_json j;
    j["format"] = format;
    j["mesh"] = setting.mesh;
    j["notes"] = setting.notes;
    j["direction"] = json_of(c.direction);
    j["speed"] = c.speed;
    j["viscosity"] = c.viscosity;
    j["density"] = c.density;
    j["resolution"] = c.resolution;
    j["start_up"] = c.start_up;
    j["duration"] = c.duration;
    j["confidence"] = c.confidence;
    j["section"] = c.section;
    if (c.section) j["section_normal"] = json_of(c.section_normal);
    j["slab"] = c.slab;
    j["turn"] = c.turn;
    j["spin"] = json_of(c.spin);
    j["axes"] = nlohmann::ordered_json::array();
    for (const Vec3d& axis : flow.plan.axes) j["axes"].push_back(json_of(axis));
    j["reference_length"] = flow.plan.reference_length;
    j["fastest"] = results.speed;
    j["travelled"] = results.travelled;
    j["lift_axis"] = json_of(results.lift_axis);
    return j;
}

}  // namespace

FlowReport::FlowReport(const std::string& folder, const std::vector<std::string>& others)
    : folder_(folder, kind(), others) {
    require_report_tools();
}

void FlowReport::write(const FlowSetting& setting, const bake::FlowSeries& flow, const FlowResults& results) {
    const ProgressBar catches_interrupts("report");
    nlohmann::ordered_json j = json_of(flow, results);
    j["report"] = describe(setting, flow, results);
    const std::string slices = slices_of(flow, j["report"]["slices"]);
    write_file(folder_.temporary() / slices_name, slices);
    write_file(folder_.temporary() / series_name, csv_of(flow));
    write_file(folder_.temporary() / json_name,
               j.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n");
    write_flow_page(folder_.temporary());
    folder_.publish();
}

std::vector<std::string> FlowReport::files(const std::string& folder) { return ReportFolder::paths(folder, kind()); }

}  // namespace frm::cli
