// What the commands share: how each joins the program, how it fails, and small readers of arguments.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <stdexcept>
#include <string>

namespace frm::cli {

/// Ends the program with status 1 and this text on standard error.
class Failure : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// Ends the program with status 1; what there was to say has been said.
struct Unsuccessful {};

// Each adds its sub-command; the command runs when its arguments have been read.
void add_bake(CLI::App& app);
void add_info(CLI::App& app);
void add_verify(CLI::App& app);
void add_flow(CLI::App& app);
void add_force(CLI::App& app);
void add_run(CLI::App& app);
void add_replay(CLI::App& app);
void add_bench(CLI::App& app);

using Numbers = std::array<double, 3>;

/// "x,y,z"; throws Failure naming the option.
Numbers read_vector(const std::string& text, const std::string& option);
/// As read_vector, and of length 1 afterwards.
Numbers read_direction(const std::string& text, const std::string& option);
void require_positive(double value, const std::string& option);

}  // namespace frm::cli
