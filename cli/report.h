// The pages that show a run and a flow: drawn by the Python package (bindings/python/frm/report.py, flow_report.py).
#pragma once

#include <string>

namespace frm::cli {

/// Throws Failure if the interpreter, the package or matplotlib is missing: to be known before a run, not after it.
void require_report_tools();

/// Replays the recording and writes the page. Throws Failure.
void write_report(const std::string& recording, const std::string& run_json, const std::string& page);

/// Draws report.html in a folder that holds the rest of a flow's report (cli/flow_report.h). Throws Failure.
void write_flow_page(const std::string& folder);

}  // namespace frm::cli
