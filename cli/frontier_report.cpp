#include "cli/frontier_report.h"

#include <cstdio>

namespace frm::cli {
namespace {

nlohmann::ordered_json json_of(const Errors& errors) {
    nlohmann::ordered_json j = nlohmann::ordered_json::object();
    for (const auto& [name, m] : errors) j[name] = {{"rms", m.rms}, {"worst", m.worst}};
    return j;
}

std::string percent(const std::optional<Errors>& errors, const std::string& of) {
    if (!errors || !errors->count(of)) return "-";
    char text[24];
    std::snprintf(text, sizeof text, "%.3g", 100 * errors->at(of).rms);
    return text;
}

}  // namespace

double FrontierRow::error() const {
    for (const std::optional<Errors>* errors : {&exact, &finest, &knob_finest})
        if (*errors)
            for (const char* of : {"height", "force"})
                if ((*errors)->count(of)) return (*errors)->at(of).rms;
    return 0;
}

void FrontierTable::mark_frontier() {
    std::vector<double> time, error;
    std::vector<FrontierRow*> own;
    for (FrontierRow& row : rows) {
        if (row.peer) continue;
        own.push_back(&row);
        time.push_back(row.us_at_500_hz);
        error.push_back(row.error());
    }
    const std::vector<bool> best = frontier_of(time, error);
    for (std::size_t i = 0; i < own.size(); ++i) own[i]->frontier = best[i];
}

nlohmann::ordered_json FrontierTable::json() const {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const FrontierRow& r : rows) {
        nlohmann::ordered_json row{{"knob", r.knob},        {"label", r.label},
                                   {"value", r.value},      {"default", r.standard},
                                   {"peer", r.peer},        {"dt", r.dt},
                                   {"tick_us", r.tick_us},  {"us_at_500_hz", r.us_at_500_hz},
                                   {"ratio", r.ratio},      {"ratio_quartiles", {r.low, r.high}},
                                   {"frontier", r.frontier}};
        if (r.map_bytes) row["map_bytes"] = r.map_bytes;
        nlohmann::ordered_json errors = nlohmann::ordered_json::object();
        if (r.exact) errors["exact"] = json_of(*r.exact);
        if (r.finest) errors["finest"] = json_of(*r.finest);
        if (r.knob_finest) errors["knob_finest"] = json_of(*r.knob_finest);
        row["error"] = errors;
        list.push_back(std::move(row));
    }
    return {{"scene", scene},
            {"what", what},
            {"reference", reference},
            {"error_of", error_of},
            {"peak_force", peak_force},
            {"peak_torque", peak_torque},
            {"rows", list}};
}

void FrontierTable::print() const {
    std::printf("%s: %s\n", scene.c_str(), what.c_str());
    if (!reference.empty()) std::printf("finest: %s\n", reference.c_str());
    if (peak_force > 0) std::printf("shares of a peak force of %.4g N\n", peak_force);
    std::printf("  %-28s %-20s %10s %18s %9s %9s %9s\n", "knob", "setting", "us a 2 ms", "of the default's", "exact %",
                "finest %", "knob %");
    for (const FrontierRow& r : rows) {
        char ratio[40];
        std::snprintf(ratio, sizeof ratio, "%.3g (%.3g-%.3g)", r.ratio, r.low, r.high);
        std::printf("%s %-28s %-20s %10.4g %18s %9s %9s %9s%s\n", r.frontier ? "*" : " ", r.knob.c_str(),
                    r.label.c_str(), r.us_at_500_hz, ratio, percent(r.exact, error_of).c_str(),
                    percent(r.finest, error_of).c_str(), percent(r.knob_finest, error_of).c_str(),
                    r.standard ? "  default" : "");
    }
    std::printf("* nothing is both faster and better; errors are rms of the %s\n\n", error_of.c_str());
    std::fflush(stdout);
}

}  // namespace frm::cli
