// What `frm bake --report` leaves: a folder with what a person would look at before trusting a map, and a page that
// shows it.
#pragma once

#include <string>
#include <vector>

#include "bake/bake.h"
#include "cli/command.h"
#include "cli/report_folder.h"

namespace frm::cli {

/// A map as it was made and written.
struct MadeMap {
    const bake::BakePlan& plan;
    const std::vector<bake::TaskResult>& results;
    const Map& map;
    const bake::Tables& tables;
    const bake::BakeReport& report;
    std::string file;
    std::size_t file_bytes = 0;
    double seconds = 0;  ///< wall time of this run
};

class BakePage {
public:
    /// To be made before the bake: throws Failure if the folder cannot be written, or holds anything but an older
    /// report of a bake and what the same command writes (`others`). That there are no tools for the page is noted only: they may come while the bake runs, and the data
    /// is good without.
    BakePage(const std::string& folder, const std::vector<std::string>& others);

    /// Writes the data, draws the page, and gives the folder its name. Throws Failure if the data cannot be written.
    void write(const MadeMap& made);
    /// After write(): why there is no page, and what to do; empty if there is one.
    const std::string& problem() const { return problem_; }

    /// The files of a report in `folder`; none if that is empty.
    static std::vector<std::string> files(const std::string& folder);

private:
    std::string name_, problem_;
    ReportFolder folder_;
};

/// --report DIR.
void add_report_option(CLI::App& command, std::string& folder);
/// Last of a command: says where the page is, or throws Failure if there is none.
void end_report(const BakePage& page, const std::string& folder, bool json);

}  // namespace frm::cli
