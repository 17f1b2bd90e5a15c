#include "cli/arguments.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace frm::cli {
namespace {

bool parse_number(const std::string& text, double& out) {
    char* end = nullptr;
    out = std::strtod(text.c_str(), &end);
    return !text.empty() && *end == 0 && std::isfinite(out);
}

std::string short_text(double v) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", v);
    return text;
}

CLI::Validator number_that(const std::string& rule, const std::function<bool(double)>& good) {
    return {[=](std::string& text) -> std::string {
                double v = 0;
                return parse_number(text, v) && good(v) ? "" : text + " is not " + rule;
            },
            ""};
}

void read_vector(const std::string& name, const std::string& text, Numbers& out) {
    if (!parse_vector(text, out)) throw CLI::ValidationError(name, text + " is not three numbers, such as 0,1,0");
}

void read_direction(const std::string& name, const std::string& text, Numbers& out) {
    read_vector(name, text, out);
    const double size = length(out);
    if (!(size > 0) || !std::isfinite(size)) throw CLI::ValidationError(name, text + " has no direction");
    for (double& x : out) x /= size;
}

}  // namespace

double length(const Numbers& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

CLI::Validator number_within(double low, double high) {
    return number_that("a number from " + short_text(low) + " to " + short_text(high),
                       [=](double v) { return v >= low && v <= high; });
}

CLI::Validator speed_or_zero() {
    return number_that("0 or a number from 1e-06 to 10000", [](double v) { return v == 0 || (v >= 1e-6 && v <= 1e4); });
}

CLI::Validator positive() {
    return number_that("a number above 0", [](double v) { return v > 0; });
}

CLI::Validator whole_within(long low, long high) {
    return {[=](std::string& text) -> std::string {
                const bool digits =
                    !text.empty() && text.size() < 12 && text.find_first_not_of("0123456789") == std::string::npos;
                const long v = digits ? std::strtol(text.c_str(), nullptr, 10) : -1;
                if (v < low || v > high)
                    return text + " is not a whole number from " + std::to_string(low) + " to " + std::to_string(high);
                text = std::to_string(v);
                return "";
            },
            ""};
}

CLI::Validator not_empty() {
    return {[](std::string& text) -> std::string { return text.empty() ? "the path is empty" : ""; }, ""};
}

CLI::Validator one_of(const std::vector<std::string>& words) {
    return {[=](std::string& text) -> std::string {
                return std::count(words.begin(), words.end(), text)
                           ? ""
                           : text + " is not one of " + CLI::detail::join(words, ", ");
            },
            ""};
}

bool parse_vector(const std::string& text, Numbers& out) {
    std::string rest = text;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t comma = rest.find(',');
        if ((comma == std::string::npos) != (k == 2) || !parse_number(rest.substr(0, comma), out[k])) return false;
        if (k < 2) rest = rest.substr(comma + 1);
    }
    return true;
}

CLI::Option* add_vector(CLI::App& command, const std::string& name, Numbers& out, double longest,
                        const std::string& help) {
    const auto read = [&out, name, longest](const std::string& text) {
        read_vector(name, text, out);
        if (!(length(out) <= longest))
            throw CLI::ValidationError(name, text + " is longer than " + short_text(longest));
    };
    return command.add_option_function<std::string>(name, read, help)->type_name("X,Y,Z");
}

CLI::Option* add_direction(CLI::App& command, const std::string& name, Numbers& out, const std::string& help) {
    return command
        .add_option_function<std::string>(
            name, [&out, name](const std::string& text) { read_direction(name, text, out); }, help)
        ->type_name("X,Y,Z");
}

CLI::Option* add_direction_or_auto(CLI::App& command, const std::string& name, Numbers& out, bool& automatic,
                                   const std::string& help) {
    const auto read = [&out, &automatic, name](const std::string& text) {
        automatic = text == "auto";
        if (!automatic) read_direction(name, text, out);
    };
    return command.add_option_function<std::string>(name, read, help)->type_name("[X,Y,Z]");
}

std::vector<std::string> arguments_of(int argc, char** argv) {
    std::vector<std::string> arguments;
    for (int i = argc - 1; i > 0; --i) {
        const std::string text = argv[i];
        Numbers ignored{};
        if (text != "--section") {
            arguments.push_back(text);
        } else if (!arguments.empty() && (arguments.back() == "auto" || parse_vector(arguments.back(), ignored))) {
            arguments.back() = "--section=" + arguments.back();
        } else {
            arguments.push_back("--section=auto");
        }
    }
    return arguments;
}

std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
    std::vector<CLI::App*> chosen;
    std::string name = "frm";
    for (std::vector<CLI::App*> next = app.get_subcommands(); !next.empty(); next = next.front()->get_subcommands()) {
        chosen = next;
        name += " " + next.front()->get_name();
    }
    const CLI::App& command = chosen.empty() ? app : *chosen.front();
    const std::vector<std::string> unknown = command.remaining();
    const bool is_missing = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::RequiredError);
    const bool is_extra = error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError);

    std::string text = error.what();
    if ((is_missing || is_extra) && !unknown.empty())
        text = unknown.front() + (unknown.front()[0] == '-' ? ": no such option"
                                  : chosen.empty()          ? ": no such command"
                                                            : ": not expected here");
    else if (is_missing && chosen.empty())
        text = "a command is needed";
    std::replace(text.begin(), text.end(), '\n', ' ');
    return name + ": " + text + " (see " + name + " --help)";
}

}  // namespace frm::cli
