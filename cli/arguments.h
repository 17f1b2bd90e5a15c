// Checks of what the user typed. What fails is a usage error that names the option.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <string>
#include <vector>

namespace frm::cli {

using Numbers = std::array<double, 3>;

double length(const Numbers& v);

/// A finite number from `low` to `high`.
CLI::Validator number_within(double low, double high);
/// A finite number above zero.
CLI::Validator positive();
/// A whole number from `low` to `high`.
CLI::Validator whole_within(long low, long high);
/// A path.
CLI::Validator not_empty();
CLI::Validator one_of(const std::vector<std::string>& words);

// The ranges of include/frm.h and of the solver.
inline CLI::Validator density_range() { return number_within(1e-3, 1e5); }
inline CLI::Validator viscosity_range() { return number_within(1e-9, 1e2); }
inline CLI::Validator stream_speed_range() { return number_within(1e-6, 1e4); }
/// The same, or 0.
CLI::Validator speed_or_zero();

/// Three finite numbers, "x,y,z", and nothing else.
bool parse_vector(const std::string& text, Numbers& out);
/// An option for x,y,z, no longer than `longest`.
CLI::Option* add_vector(CLI::App& command, const std::string& name, Numbers& out, double longest,
                        const std::string& help);
/// An option for x,y,z, of length 1 afterwards.
CLI::Option* add_direction(CLI::App& command, const std::string& name, Numbers& out, const std::string& help);
/// As add_direction, or "auto", which sets `automatic` instead.
CLI::Option* add_direction_or_auto(CLI::App& command, const std::string& name, Numbers& out, bool& automatic,
                                   const std::string& help);

/// The arguments for CLI11, last first. --section may go without a value and gets "auto" where no x,y,z follows: CLI11
/// itself would take the next argument, whatever it is, and read -1,0,0 as an option.
std::vector<std::string> arguments_of(int argc, char** argv);

/// One line about what was wrong with the arguments.
std::string usage_error(const CLI::App& app, const CLI::ParseError& error);

}  // namespace frm::cli
