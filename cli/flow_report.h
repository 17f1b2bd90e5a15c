// What `frm flow --report` leaves: a folder with the results, the series, slices of the flow, and a page that shows them.
#pragma once

#include <string>
#include <vector>

#include "bake/flow/flow.h"
#include "cli/flow_results.h"
#include "cli/report_folder.h"

namespace frm::cli {

/// What the page says of the case besides the results.
struct FlowSetting {
    std::string mesh;
    std::vector<std::string> notes;
    bake::FlowCase flow;
};

class FlowReport {
public:
    /// To be made before the run: throws Failure if the folder cannot be written, holds anything but an older report of
    /// a flow and what the same command writes (`others`), or if there are no tools for the page.
    FlowReport(const std::string& folder, const std::vector<std::string>& others);

    /// Writes the files, draws the page, and gives the folder its name. Throws Failure.
    void write(const FlowSetting& setting, const bake::FlowSeries& flow, const FlowResults& results);

    /// The files of a report in `folder`.
    static std::vector<std::string> files(const std::string& folder);

private:
    ReportFolder folder_;
};

}  // namespace frm::cli
