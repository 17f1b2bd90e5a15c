// frm replay: does a recording give the same bits again?
#include <cmath>
#include <cstdio>
#include <memory>

#include "cli/command.h"
#include "cli/file.h"
#include "cli/frm_object.h"
#include "cli/progress.h"
#include "cli/recording_csv.h"

namespace frm::cli {
namespace {

struct Options {
    std::string file, from, to, csv, device_csv;
    double tolerance = 0, force = 0, torque = 0;
    bool json = false;
};

const char* part_name(std::uint32_t part) {
    switch (part) {
        case FRM_PART_BUOYANCY:
            return "buoyancy";
        case FRM_PART_PRESSURE:
            return "pressure";
        case FRM_PART_FRICTION:
            return "friction";
        case FRM_PART_GRAVITY:
            return "gravity";
        case FRM_PART_TOTAL:
            return "total";
        case FRM_PART_WORLD:
            return "world";
        default:
            return "none";
    }
}

const char* component_name(std::uint32_t component) {
    static const char* const names[] = {"force.x", "force.y", "force.z", "torque.x", "torque.y", "torque.z"};
    return component < 6 ? names[component] : "";
}

/// The tables that were asked for; nothing is replayed.
void run_csv(const Options& o, const Moment& from, const Moment& to) {
    require_distinct({o.csv, o.device_csv}, {o.file});
    const CsvCounts counts = write_csv(o.file, o.csv, o.device_csv, from, to);
    if (counts.ticks == 0) print_note("no tick of the recording lies in the range that was given");
    if (counts.gap) print_note("the recording has a gap: events were lost when it was made");
    if (o.json)
        std::printf("%s\n", nlohmann::ordered_json{{"file", o.file},
                                                   {"ticks", counts.ticks},
                                                   {"exchanges", counts.exchanges},
                                                   {"torn", counts.torn},
                                                   {"gap", counts.gap}}
                                .dump(2)
                                .c_str());
    else
        std::printf("%s: %llu ticks, %llu exchanges written%s\n", o.file.c_str(),
                    static_cast<unsigned long long>(counts.ticks), static_cast<unsigned long long>(counts.exchanges),
                    counts.torn ? "; the recording was cut off there" : "");
}

nlohmann::ordered_json json_of(const frm_replay_step_result& r) {
    nlohmann::ordered_json j{{"tick", r.tick}, {"time", r.time}, {"body", r.body}, {"part", part_name(r.part)}};
    if (r.part == FRM_PART_WORLD || !std::isfinite(r.recorded)) return j;
    j["component"] = component_name(r.component);
    j["recorded"] = r.recorded;
    j["replayed"] = r.replayed;
    return j;
}

std::string text_of(const frm_replay_step_result& r) {
    char text[240];
    int n = std::snprintf(text, sizeof text, "differs first at tick %llu, t = %.9g s, body %u, part %s",
                          static_cast<unsigned long long>(r.tick), r.time, r.body, part_name(r.part));
    if (r.part == FRM_PART_WORLD || n < 0) return text;
    const auto at = static_cast<std::size_t>(n);
    if (std::isfinite(r.recorded))
        std::snprintf(text + at, sizeof text - at, " %s: recorded %.9g, replayed %.9g (%s)",
                      component_name(r.component), static_cast<double>(r.recorded), static_cast<double>(r.replayed),
                      r.component < 3 ? "N" : "N m");
    else
        std::snprintf(text + at, sizeof text - at, " (of this tick only a check was kept)");
    return text;
}

void run(const Options& o) {
    Moment from, to;
    if (!o.from.empty()) parse_moment(o.from, from);
    if (!o.to.empty()) parse_moment(o.to, to);
    if (!o.csv.empty() || !o.device_csv.empty()) return run_csv(o, from, to);

    const Session session;
    frm_replay replay = 0;
    session.check(frm_replay_open(session.context(), o.file.c_str(), &replay));
    frm_replay_info info{};
    info.struct_size = sizeof info;
    session.check(frm_replay_get_info(replay, &info));
    frm_replay_tolerance tolerance{sizeof tolerance, static_cast<float>(o.tolerance), static_cast<float>(o.force),
                                   static_cast<float>(o.torque)};
    session.check(frm_replay_set_tolerance(replay, &tolerance));
    const bool exact = o.tolerance == 0 && o.force == 0 && o.torque == 0;

    // What comes before the range is lived all the same: its ticks make the state that the range begins with.
    frm_replay_step_result result{}, first{};
    result.struct_size = sizeof result;
    std::uint64_t replayed = 0, compared = 0;
    {
        ProgressBar bar("replay");
        while (!first.diverged) {
            const frm_status status = frm_replay_step(replay, &result);
            if (status == FRM_ERROR_END) break;
            session.check(status);
            if (!not_after(to, result.tick, result.time)) break;
            ++replayed;
            if (not_before(from, result.tick, result.time)) {
                ++compared;
                if (result.diverged) first = result;
            }
            if (replayed % 64 == 0 && !bar.update(static_cast<double>(replayed) / static_cast<double>(info.ticks), ""))
                throw Failure("interrupted after " + std::to_string(replayed) + " of " + std::to_string(info.ticks) +
                              " ticks");
        }
    }
    if (compared == 0 && info.ticks > 0)
        throw Failure(o.file + ": no tick of its " + std::to_string(info.ticks) + " lies in the range that was given");
    if (o.json) {
        nlohmann::ordered_json j{{"file", o.file},
                                 {"ticks", info.ticks},
                                 {"replayed", replayed},
                                 {"compared", compared},
                                 {"torn", info.torn != 0},
                                 {"lost_events", info.lost_events},
                                 {"identical", exact && !first.diverged},
                                 {"within_tolerance", !first.diverged}};
        if (first.diverged) j["first_difference"] = json_of(first);
        std::printf("%s\n", j.dump(2).c_str());
    } else if (first.diverged) {
        std::printf("%s: %s\n", o.file.c_str(), text_of(first).c_str());
    } else {
        const std::string of = compared < info.ticks ? " of " + std::to_string(info.ticks) : "";
        std::printf("%s: %llu%s ticks (%.4g s), %s%s%s\n", o.file.c_str(), static_cast<unsigned long long>(compared),
                    of.c_str(), info.time, exact ? "identical bit for bit" : "within the tolerance",
                    info.torn ? "; the recording was cut off there" : "",
                    info.lost_events ? "; there events were lost when it was made" : "");
    }
    if (first.diverged) throw Unsuccessful();
}

}  // namespace

void add_replay(CLI::App& app) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand(
        "replay",
        "Lives a recording again and compares every force bit for bit, or within a tolerance. Exit\n"
        "status 1, and the first difference, if it does not come out the same. Or makes tables of it.");
    command->footer(
        "docs/replay.md has the columns, and how to keep recordings as tests.\n"
        "  frm replay run.frmrec --from 1.5 --to 2000t --csv run.csv   from 1.5 s to tick 2000");
    Options& o = *options;
    command->add_option("FILE", o.file, "a recording made with frm run --record, or by a host")
        ->required()
        ->check(not_empty())
        ->type_name("");
    command
        ->add_option("--tolerance", o.tolerance,
                     "forces and torques may be off by this share of the largest on their body in the recording")
        ->check(number_within(0, 1))
        ->type_name("SHARE");
    command->add_option("--force", o.force, "and forces by so much besides")
        ->check(number_within(0, 1e9))
        ->type_name("N");
    command->add_option("--torque", o.torque, "and torques")->check(number_within(0, 1e9))->type_name("N_M");
    const CLI::Validator moment(
        [](std::string& text) {
            Moment m;
            return parse_moment(text, m) ? std::string() : "\"" + text + "\" is not a time (1.5) or a tick (300t)";
        },
        "");
    command->add_option("--from", o.from, "the first tick that is looked at: a time in s, or a tick as 300t")
        ->check(moment)
        ->type_name("T");
    command->add_option("--to", o.to, "the last")->check(moment)->type_name("T");
    command
        ->add_option("--csv", o.csv, "write motions and forces to this file, a row for each tick and body; no replay")
        ->check(not_empty())
        ->type_name("FILE");
    command
        ->add_option("--device-csv", o.device_csv,
                     "write what devices were told and said, a row for each exchange, with the raw packet; no replay")
        ->check(not_empty())
        ->type_name("FILE");
    command->add_flag("--json", options->json, "JSON on standard output");
    command->callback([options] { run(*options); });
}

}  // namespace frm::cli
