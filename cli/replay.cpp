// frm replay: does a recording give the same bits again?
#include <cstdio>
#include <memory>

#include "cli/command.h"
#include "cli/frm_object.h"
#include "cli/progress.h"

namespace frm::cli {
namespace {

struct Options {
    std::string file;
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

void run(const Options& o) {
    const Session session;
    frm_replay replay = 0;
    session.check(frm_replay_open(session.context(), o.file.c_str(), &replay));
    frm_replay_info info{};
    info.struct_size = sizeof info;
    session.check(frm_replay_get_info(replay, &info));

    frm_replay_step_result result{};
    result.struct_size = sizeof result;
    std::uint64_t replayed = 0;
    {
        ProgressBar bar("replay");
        while (!result.diverged) {
            const frm_status status = frm_replay_step(replay, &result);
            if (status == FRM_ERROR_END) break;
            session.check(status);
            ++replayed;
            if (replayed % 64 == 0 && !bar.update(static_cast<double>(replayed) / static_cast<double>(info.ticks), ""))
                throw Failure("interrupted after " + std::to_string(replayed) + " of " + std::to_string(info.ticks) +
                              " ticks");
        }
    }
    if (o.json) {
        nlohmann::ordered_json j{{"file", o.file},
                                 {"ticks", info.ticks},
                                 {"replayed", replayed},
                                 {"torn", info.torn != 0},
                                 {"identical", !result.diverged}};
        if (result.diverged)
            j["first_difference"] = {{"tick", result.tick}, {"body", result.body}, {"part", part_name(result.part)}};
        std::printf("%s\n", j.dump(2).c_str());
    } else if (result.diverged) {
        std::printf("%s: differs first at tick %llu, body %u, part %s\n", o.file.c_str(),
                    static_cast<unsigned long long>(result.tick), result.body, part_name(result.part));
    } else {
        std::printf("%s: %llu ticks (%.4g s), identical bit for bit%s\n", o.file.c_str(),
                    static_cast<unsigned long long>(replayed), info.time,
                    info.torn ? "; the recording was cut off there" : "");
    }
    if (result.diverged) throw Unsuccessful();
}

}  // namespace

void add_replay(CLI::App& app) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        app.add_subcommand("replay",
                           "Lives a recording again and compares every force bit for bit. Exit status 1, and\n"
                           "the first tick, body and part that differ, if it does not come out the same.");
    command->add_option("FILE", options->file, "a recording made with frm run --record, or by a host")
        ->required()
        ->check(not_empty())
        ->type_name("");
    command->add_flag("--json", options->json, "JSON on standard output");
    command->callback([options] { run(*options); });
}

}  // namespace frm::cli
