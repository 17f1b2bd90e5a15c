// What a recording holds, as tables (docs/replay.md has the columns).
#pragma once

#include <cstdint>
#include <string>

namespace frm::cli {

/// A place in a recording: a time, or a tick.
struct Moment {
    double seconds = -1;
    std::uint64_t tick = 0;
    bool given = false;
};

/// "1.5" is a time in s, "300t" a tick. False for anything else.
bool parse_moment(const std::string& text, Moment& out);
/// Whether a tick (and the time after it) is not before `from`, or not after `to`.
bool not_before(const Moment& from, std::uint64_t tick, double time);
bool not_after(const Moment& to, std::uint64_t tick, double time);

struct CsvCounts {
    std::uint64_t ticks = 0, exchanges = 0;
    bool torn = false, gap = false;
};

/// Writes the ticks (one row a body), the exchanges (one row each), or both; an empty path is left out. The files appear
/// whole or not at all.
CsvCounts write_csv(const std::string& recording, const std::string& ticks, const std::string& exchanges,
                    const Moment& from, const Moment& to);

}  // namespace frm::cli
