// What `frm flow --report` leaves: a folder with the results, the series, slices of the flow, and a page that shows them.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "bake/flow/flow.h"
#include "cli/flow_results.h"

namespace frm::cli {

/// What the page says of the case besides the results.
struct FlowSetting {
    std::string mesh;
    std::vector<std::string> notes;
    bake::FlowCase flow;
};

/// The folder, made under another name and given its own when all is in it. What is not finished is removed.
class FlowReport {
public:
    /// To be made before the run: throws Failure if the folder cannot be written, holds anything but an older report of
    /// a flow, or if there are no tools for the page.
    explicit FlowReport(const std::string& folder);
    ~FlowReport();
    FlowReport(const FlowReport&) = delete;
    FlowReport& operator=(const FlowReport&) = delete;

    /// Writes the files, draws the page, and gives the folder its name. Throws Failure.
    void write(const FlowSetting& setting, const bake::FlowSeries& flow, const FlowResults& results);

    /// The files of a report in `folder`.
    static std::vector<std::string> files(const std::string& folder);

private:
    void publish();

    std::filesystem::path folder_, temporary_;
};

}  // namespace frm::cli
