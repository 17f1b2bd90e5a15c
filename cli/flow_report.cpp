#include "cli/flow_report.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

#include "cli/command.h"
#include "cli/file.h"
#include "cli/progress.h"
#include "cli/report.h"

namespace frm::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* page_name = "report.html";
constexpr const char* json_name = "flow.json";
constexpr const char* series_name = "series.csv";
constexpr const char* slices_name = "slices.f32";
constexpr const char* format = "frm flow report 1";

[[noreturn]] void fail(const fs::path& path, const std::error_code& error) {
    throw Failure("--report: " + path.string() + ": " + error.message());
}

/// An empty folder, or a report of a flow and nothing else.
bool may_be_replaced(const fs::path& folder) {
    bool empty = true;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
        empty = false;
        const std::string name = entry.path().filename().string();
        if (name != page_name && name != json_name && name != series_name && name != slices_name) return false;
    }
    if (empty) return true;
    std::ifstream file(folder / json_name, std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    return text.find(format) != std::string::npos;
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

FlowReport::FlowReport(const std::string& folder) {
    std::error_code error;
    folder_ = fs::weakly_canonical(fs::absolute(folder), error);
    if (error) fail(folder, error);
    const bool there = fs::exists(folder_, error);
    if (there && !fs::is_directory(folder_, error)) throw Failure("--report: " + folder + ": is not a folder");
    try {
        if (there && !may_be_replaced(folder_))
            throw Failure("--report: " + folder + ": holds other files; name a new or an empty folder");
    } catch (const fs::filesystem_error& e) {
        fail(folder, e.code());
    }
    require_report_tools();
    // Inside a folder that is there, because what is beside it may be another file system or somebody else's; beside
    // the topmost folder that is not there yet, so that a run that fails leaves none.
    fs::path where = folder_;
    while (!fs::exists(where, error)) where = where.parent_path();
    temporary_ = where / (".frm_flow.tmp" + std::to_string(getpid()));
    if (!fs::create_directory(temporary_, error)) {
        temporary_.clear();
        fail(folder, error ? error : std::make_error_code(std::errc::file_exists));
    }
}

FlowReport::~FlowReport() {
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void FlowReport::write(const FlowSetting& setting, const bake::FlowSeries& flow, const FlowResults& results) {
    const ProgressBar catches_interrupts("report");
    nlohmann::ordered_json j = json_of(flow, results);
    j["report"] = describe(setting, flow, results);
    const std::string slices = slices_of(flow, j["report"]["slices"]);
    write_file(temporary_ / slices_name, slices);
    write_file(temporary_ / series_name, csv_of(flow));
    write_file(temporary_ / json_name, j.dump(2) + "\n");
    write_flow_page(temporary_);
    publish();
}

std::vector<std::string> FlowReport::files(const std::string& folder) {
    std::vector<std::string> paths;
    for (const char* name : {page_name, json_name, series_name, slices_name}) paths.push_back(folder + "/" + name);
    return paths;
}

void FlowReport::publish() {
    std::error_code error;
    if (fs::exists(folder_, error)) {
        for (const char* name : {slices_name, series_name, json_name, page_name}) {
            fs::rename(temporary_ / name, folder_ / name, error);
            if (error) fail(folder_ / name, error);
        }
        return;
    }
    fs::create_directories(folder_.parent_path(), error);
    if (!error) fs::rename(temporary_, folder_, error);
    if (error) fail(folder_, error);
    temporary_.clear();
}

}  // namespace frm::cli
