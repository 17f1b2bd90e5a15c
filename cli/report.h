// The page that shows a run: drawn by the Python package (bindings/python/frm/report.py) from the recording.
#pragma once

#include <string>

namespace frm::cli {

/// Throws Failure if the interpreter, the package or matplotlib is missing: to be known before a run, not after it.
void require_report_tools();

/// Replays the recording and writes the page. Throws Failure.
void write_report(const std::string& recording, const std::string& run_json, const std::string& page);

}  // namespace frm::cli
