// What the commands share: how each joins the program, and how it fails.
#pragma once

#include <CLI/CLI.hpp>
#include <stdexcept>

#include "cli/arguments.h"

namespace frm::cli {

/// Ends the program with status 1 and this text on standard error.
class Failure : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Ends the program with this status; what there was to say has been said.
struct Unsuccessful {
    int status = 1;
};

// Each adds its sub-command; the command runs when its arguments have been read.
void add_bake(CLI::App& app);
void add_info(CLI::App& app);
void add_verify(CLI::App& app);
void add_mesh(CLI::App& app);
void add_flow(CLI::App& app);
void add_force(CLI::App& app);
void add_run(CLI::App& app);
void add_servo(CLI::App& app);
void add_replay(CLI::App& app);
void add_device(CLI::App& app);
void add_bench(CLI::App& app);

}  // namespace frm::cli
