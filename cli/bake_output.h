// The end of a bake: the map's file, and what is said of it.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bake/bake.h"
#include "cli/command.h"

namespace frm::cli {

class BakePage;

/// Throws Failure now if the map could not be written to `out` after hours. A file that is there is replaced if it is a
/// map and was `named` by the user, or if `force` says so.
void require_map_place(const std::string& out, bool named, bool force);

/// The same of the unrounded tables, if they are asked for: a file that is there is replaced if it holds such, or by `force`.
void require_raw_place(const std::string& raw, bool force);
void add_raw_option(CLI::App& command, std::string& raw);

/// NAME.frm in the current folder, for a mesh NAME.glb anywhere.
std::string default_map(const std::string& mesh);

struct BakeRun {
    double seconds = 0;        ///< wall time of this run
    double updates = 0;        ///< cell updates done in this run
    std::string raw;           ///< where the unrounded tables go; empty: nowhere
    BakePage* page = nullptr;  ///< gets what the report shows
    bool json = false;
};

/// Makes the map, writes it, and says so on standard output; `before_words` is called in between. Last the report.
void finish_map(
    const bake::BakePlan& plan, const std::vector<bake::TaskResult>& results, const std::string& out,
    const BakeRun& run, const std::function<void()>& before_words = [] {});

}  // namespace frm::cli
