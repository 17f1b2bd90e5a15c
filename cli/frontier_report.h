// What `frm bench frontier` found: rows of time and error, as JSON and as text.
#pragma once

#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "cli/frontier_error.h"

namespace frm::cli {

/// By what is compared: "force", "torque", "height".
using Errors = std::map<std::string, Measure>;

struct FrontierRow {
    std::string knob, label;
    double value = 0;
    bool standard = false;  ///< the default
    bool peer = false;      ///< not frm
    double dt = 0;          ///< s of a tick
    double tick_us = 0;
    double us_at_500_hz = 0;              ///< of 2 ms of the scene, whatever the tick
    double ratio = 1, low = 1, high = 1;  ///< of that over the default's: median and quartiles over the repeats
    std::uint64_t map_bytes = 0;
    std::optional<Errors> finest;       ///< against all knobs at their finest
    std::optional<Errors> knob_finest;  ///< against this knob at its finest, all else as by default
    std::optional<Errors> exact;
    bool frontier = false;  ///< no other setting is faster and better

    /// What the frontier is of: against what is exact, else against the finest of all, else of the knob.
    double error() const;
};

struct FrontierTable {
    std::string scene, what, reference;
    std::string error_of;  ///< "force" or "height"
    double peak_force = 0, peak_torque = 0;
    std::vector<FrontierRow> rows;

    void mark_frontier();
    nlohmann::ordered_json json() const;
    void print() const;
};

}  // namespace frm::cli
