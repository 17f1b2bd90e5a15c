// frm bench frontier: run time against error, setting by setting.
#pragma once

#include <CLI/CLI.hpp>

namespace frm::cli {

/// Adds the sub-command to `bench`.
void add_frontier(CLI::App& bench);

}  // namespace frm::cli
