// frm info, frm verify.
#include <cstdio>
#include <cstring>
#include <memory>

#include "cli/command.h"
#include "cli/frm_object.h"

namespace frm::cli {
namespace {

struct Options {
    std::string file;
    bool json = false;
};

void print_map(const frm_map_info& i, const nlohmann::ordered_json& made) {
    const auto row = [](const char* name, const char* format, auto... values) {
        std::printf("%-20s ", name);
        std::printf(format, values...);
        std::printf("\n");
    };
    const auto d = [](float v) { return static_cast<double>(v); };
    row("file", "%llu bytes, format %u, hash %016llx", static_cast<unsigned long long>(i.file_bytes), i.format_version,
        static_cast<unsigned long long>(i.content_hash));
    row("haptic sources", "%u", i.sources);
    row("directions", "%u", i.directions);
    row("series", "%u samples, period %.4g s", i.samples, d(i.period));
    row("base speed", "%g m/s", d(i.base_speed));
    row("fluid", "%g kg/m^3, %g m^2/s", d(i.density), d(i.viscosity));
    row("Reynolds number", "%.4g asked for, %.4g solved, on a length of %.4g m", d(i.reynolds), d(i.reynolds_solved),
        d(i.reference_length));
    row("quantisation error", "%.2g of the peak force", d(i.quantisation_error));
    row("surface", "%u triangles, %.4g m^2, encloses %.4g m^3", i.triangles, d(i.area), d(i.volume));
    row("bounds", "(%.4g, %.4g, %.4g) to (%.4g, %.4g, %.4g) m", d(i.bounds_low.x), d(i.bounds_low.y), d(i.bounds_low.z),
        d(i.bounds_high.x), d(i.bounds_high.y), d(i.bounds_high.z));
    for (const auto& [key, value] : made.items())
        if (key != "directions")
            row(key.c_str(), "%s", value.is_string() ? value.get<std::string>().c_str() : value.dump().c_str());
    if (!made.contains("directions")) return;
    std::printf("\n%-26s %8s %12s %10s %10s\n", "direction", "drag cf.", "uncertainty", "Re solved", "blockage");
    for (const auto& one : made["directions"]) {
        const auto& e = one["direction"];
        std::printf("(%6.3f, %6.3f, %6.3f)   %8.3f %10.1f %% %10.3g %8.1f %%\n", e[0].get<double>(), e[1].get<double>(),
                    e[2].get<double>(), one["drag_coefficient"].get<double>(), 100 * one["uncertainty"].get<double>(),
                    one["reynolds_solved"].get<double>(), 100 * one["blockage"].get<double>());
    }
}

void info(const Options& options) {
    const Session session;
    const frm_map map = session.open_map(options.file);
    const frm_map_info facts = session.map_info(map);
    const auto made = nlohmann::ordered_json::parse(session.provenance(map), nullptr, false);
    if (options.json) {
        nlohmann::ordered_json j = json_of(facts);
        j["provenance"] = made.is_discarded() ? nlohmann::ordered_json() : made;
        std::printf("%s\n", j.dump(2).c_str());
    } else {
        print_map(facts, made.is_object() ? made : nlohmann::ordered_json::object());
    }
}

bool is_recording(const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (!file) return false;
    unsigned char head[4] = {};
    const bool read = std::fread(head, 1, sizeof head, file) == sizeof head;
    std::fclose(file);
    return read && std::memcmp(head,
                               "\x89"
                               "FRR",
                               4) == 0;
}

// Opening reads every chunk or block, checks the sums and the structure; what it accepts is sound.
void verify(const Options& options) {
    const Session session;
    nlohmann::ordered_json j{{"file", options.file}};
    std::string text;
    if (is_recording(options.file)) {
        frm_replay replay = 0;
        session.check(frm_replay_open(session.context(), options.file.c_str(), &replay));
        frm_replay_info facts{};
        facts.struct_size = sizeof facts;
        session.check(frm_replay_get_info(replay, &facts));
        j["kind"] = "recording";
        j["ticks"] = facts.ticks;
        j["torn"] = facts.torn != 0;
        text = "recording, " + std::to_string(facts.ticks) + " ticks" + (facts.torn ? ", cut off at the end" : "");
    } else {
        const frm_map_info facts = session.map_info(session.open_map(options.file));
        j["kind"] = "map";
        j["sources"] = facts.sources;
        j["directions"] = facts.directions;
        text =
            "map, " + std::to_string(facts.sources) + " sources, " + std::to_string(facts.directions) + " directions";
    }
    j["sound"] = true;
    if (options.json)
        std::printf("%s\n", j.dump(2).c_str());
    else
        std::printf("%s: sound (%s; checksums and structure)\n", options.file.c_str(), text.c_str());
}

void add(CLI::App& app, const char* name, const char* help, const char* file, void (*run)(const Options&)) {
    auto options = std::make_shared<Options>();
    CLI::App* command = app.add_subcommand(name, help);
    command->add_option("FILE", options->file, file)->required()->check(not_empty())->type_name("");
    command->add_flag("--json", options->json, "JSON on standard output");
    command->callback([options, run] { run(*options); });
}

}  // namespace

void add_info(CLI::App& app) { add(app, "info", "Shows what a map holds and how it was made.", "a .frm map", info); }

void add_verify(CLI::App& app) {
    add(app, "verify", "Checks a map's or a recording's checksums and structure; exit status 1 if it is damaged.",
        "a .frm map or a recording", verify);
}

}  // namespace frm::cli
