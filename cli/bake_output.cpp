#include "cli/bake_output.h"

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "bake/map/raw.h"
#include "cli/bake_report.h"
#include "cli/command.h"
#include "cli/file.h"
#include "cli/frm_object.h"
#include "core/map/codec.h"

namespace frm::cli {
namespace {

namespace fs = std::filesystem;

/// By its first bytes; or a file without any, which is nobody's loss.
template <typename Byte, std::size_t size>
bool begins_with(const std::string& path, const Byte (&magic)[size]) {
    std::ifstream file(path, std::ios::binary);
    char head[size] = {};
    file.read(head, size);
    return file.gcount() == 0 || (file.gcount() == size && std::memcmp(head, magic, size) == 0);
}

/// The notes and what is on standard output.
void say(const bake::BakePlan& plan, const Map& map, const bake::BakeReport& report, const std::string& out,
         std::size_t bytes, const BakeRun& run) {
    const double worst = report.uncertainty;
    const bake::DirectionErrors& between = report.direction_errors;
    const bool missed = plan.budget.rms > 0 && (between.rms > plan.budget.rms || between.worst > plan.budget.worst);
    if (missed)
        std::fprintf(stderr,
                     "note: directions are predicted from each other to %.1f %% rms and %.1f %% at worst, not the %.0f "
                     "and %.0f %% of this quality: take a higher --quality, --resolution or --directions\n",
                     100 * between.rms, 100 * between.worst, 100 * plan.budget.rms, 100 * plan.budget.worst);
    if (worst > bake::kNotedUncertainty)
        std::fprintf(stderr,
                     "note: the mean drag of a direction is uncertain by %.0f %% of the largest force: take a higher "
                     "--quality or --resolution\n",
                     100 * worst);
    const double mlups = run.seconds > 0 ? run.updates / run.seconds / 1e6 : 0;
    if (run.json) {
        nlohmann::ordered_json j{{"file", out},
                                 {"file_bytes", bytes},
                                 {"directions", map.directions.count()},
                                 {"sources", map.source_count()},
                                 {"samples", map.samples},
                                 {"flows", plan.tasks.size()},
                                 {"reynolds", map.facts.reynolds},
                                 {"reynolds_solved", map.facts.reynolds_solved},
                                 {"uncertainty", worst},
                                 {"direction_error_rms", if_known(between.rms)},
                                 {"direction_error_worst", if_known(between.worst)},
                                 {"quantisation_error", map.facts.quantisation_error},
                                 {"mlups", if_known(mlups)},
                                 {"seconds", run.seconds}};
        std::printf("%s\n", j.dump(2).c_str());
        return;
    }
    char speed[64] = "";
    if (mlups > 0) std::snprintf(speed, sizeof speed, " (%.0f million cell updates a second)", mlups);
    std::printf("%s: %.1f kB, %zu flows, %u sources, in %.1f s%s\n", out.c_str(), static_cast<double>(bytes) / 1e3,
                plan.tasks.size(), map.source_count(), run.seconds, speed);
    char predicted[64] = "not known (one flow)";
    if (between.worst > 0)
        std::snprintf(predicted, sizeof predicted, "%.1f %% rms, %.1f %% at worst", 100 * between.rms,
                      100 * between.worst);
    std::printf(
        "shares of the largest force: between directions %s; rounded to %.2g %%;\n"
        "mean drag uncertain by %.1f %% (grid and statistics of the worst direction)\n",
        predicted, 100 * static_cast<double>(map.facts.quantisation_error), 100 * worst);
}

}  // namespace

void require_map_place(const std::string& out, bool named, bool force) {
    std::error_code error;
    if (!force && fs::is_regular_file(out, error)) {
        if (!named) throw Failure(out + ": is already there; --force replaces it, or name another file with -o");
        if (!begins_with(out, format::magic)) throw Failure(out + ": is there and is not a map; --force replaces it");
    }
    require_writable(out);
}

void require_raw_place(const std::string& raw, bool force) {
    if (raw.empty()) return;
    std::error_code error;
    if (!force && fs::is_regular_file(raw, error) && !begins_with(raw, bake::raw_magic))
        throw Failure("--raw: " + raw + ": is there and holds no raw tables; --force replaces it");
    require_writable(raw);
}

void add_raw_option(CLI::App& command, std::string& raw) {
    command.add_option("--raw", raw, "write the tables too as they were before rounding (frm verify --against)")
        ->check(not_empty())
        ->type_name("FILE");
}

std::string default_map(const std::string& mesh) { return fs::path(mesh).stem().string() + ".frm"; }

void finish_map(const bake::BakePlan& plan, const std::vector<bake::TaskResult>& results, const std::string& out,
                const BakeRun& run, const std::function<void()>& before_words) {
    bake::BakeReport report;
    bake::Tables tables;
    const std::unique_ptr<Map> map = bake::make_map(plan, results, report, &tables);
    const std::vector<std::uint8_t> file = encode_map(*map);
    // The map last: while it is not there the same command goes on.
    if (!run.raw.empty()) {
        const std::vector<std::uint8_t> raw = bake::encode_raw(*map, tables);
        write_file(run.raw, raw.data(), raw.size());
    }
    write_file(out, file.data(), file.size());
    before_words();

    say(plan, *map, report, out, file.size(), run);
    std::fflush(stdout);
    if (run.page) run.page->write({plan, results, *map, tables, report, out, file.size(), run.seconds});
}

}  // namespace frm::cli
