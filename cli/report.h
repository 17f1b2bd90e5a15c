// The pages that show a run, a flow and a bake: drawn by the Python package (bindings/python/frm/report.py,
// flow_report.py, bake_report.py).
#pragma once

#include <string>

namespace frm::cli {

/// What is missing of the interpreter and matplotlib, and how to get it; empty if nothing is. Throws Failure if the
/// package is.
std::string missing_report_tools();
/// Throws Failure if the interpreter, the package or matplotlib is missing: to be known before a run, not after it.
void require_report_tools();

/// Replays the recording and writes the page. Throws Failure.
void write_report(const std::string& recording, const std::string& run_json, const std::string& page);

/// Draws report.html in a folder that holds the rest of a flow's report (cli/flow_report.h). Throws Failure.
void write_flow_page(const std::string& folder);

/// The same for a bake's (cli/bake_report.h).
void write_bake_page(const std::string& folder);

/// What to type to draw a page later: the package's module on a folder.
std::string report_command(const std::string& module, const std::string& folder);

}  // namespace frm::cli
