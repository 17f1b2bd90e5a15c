// frm info, frm verify.
#include <cstdio>
#include <cstring>
#include <memory>

#include "bake/map/raw.h"
#include "cli/command.h"
#include "cli/file.h"
#include "cli/frm_object.h"
#include "core/error.h"
#include "core/map/codec.h"

namespace frm::cli {
namespace {

struct Options {
    std::string file, against;
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
    row("directions", "%u for means, %u for fluctuations", i.directions, i.fluctuation_directions);
    row("series", "%u samples, period %.4g s", i.samples, d(i.period));
    row("base speed", "%g m/s; means at %u speed%s", d(i.base_speed), i.speeds, i.speeds == 1 ? "" : "s");
    row("spin table", "%s", i.has_spin ? "yes" : "no");
    row("added mass", "%s", i.has_added_mass ? "yes" : "no");
    row("fluid", "%g kg/m^3, %g m^2/s", d(i.density), d(i.viscosity));
    row("Reynolds number", "%.4g asked for, %.4g solved, on a length of %.4g m", d(i.reynolds), d(i.reynolds_solved),
        d(i.reference_length));
    const auto percent = [&](const char* name, float share, const char* of) {
        if (share > 0)
            row(name, "%.2g %% of %s", 100 * d(share), of);
        else
            row(name, "not known");
    };
    row("quantisation error", "%.2g %% of the peak force", 100 * d(i.quantisation_error));
    percent("direction error", i.direction_error_rms, "the peak force, rms, in directions held out of the bake");
    percent("worst of these", i.direction_error_worst, "the peak force");
    percent("uncertainty", i.uncertainty, "the peak force (the mean drag, standard error, worst direction)");
    row("surface", "%u triangles, %.4g m^2, encloses %.4g m^3", i.triangles, d(i.area), d(i.volume));
    row("bounds", "(%.4g, %.4g, %.4g) to (%.4g, %.4g, %.4g) m", d(i.bounds_low.x), d(i.bounds_low.y), d(i.bounds_low.z),
        d(i.bounds_high.x), d(i.bounds_high.y), d(i.bounds_high.z));
    for (const auto& [key, value] : made.items())
        if (key != "directions" && key != "spins")
            row(key.c_str(), "%s", value.is_string() ? value.get<std::string>().c_str() : value.dump().c_str());
    if (made.contains("directions")) {
        std::printf("\n%-26s %8s %8s %12s %10s %10s\n", "direction", "m/s", "drag cf.", "uncertainty", "Re solved",
                    "blockage");
        for (const auto& one : made["directions"]) {
            const auto& e = one["direction"];
            // Maps of before there were several have it in the facts alone.
            std::printf("(%6.3f, %6.3f, %6.3f)   %8.4g %8.3f %10.1f %% %10.3g %8.1f %%\n", e[0].get<double>(),
                        e[1].get<double>(), e[2].get<double>(), one.value("speed", d(i.base_speed)),
                        one["drag_coefficient"].get<double>(), 100 * one["uncertainty"].get<double>(),
                        one["reynolds_solved"].get<double>(), 100 * one["blockage"].get<double>());
        }
    }
    if (!made.contains("spins")) return;
    std::printf("\n%-26s %8s %21s %10s\n", "turn about", "rad/s", "uncertainty", "Re solved");
    for (const auto& one : made["spins"]) {
        const auto& e = one["direction"];
        std::printf("(%6.3f, %6.3f, %6.3f)   %8.4g %19.1f %% %10.3g\n", e[0].get<double>(), e[1].get<double>(),
                    e[2].get<double>(), one["rate"].get<double>(), 100 * one["uncertainty"].get<double>(),
                    one["reynolds_solved"].get<double>());
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

/// The error of the map's rounding, worked out from the tables before they were rounded, must not be above what the map
/// says of itself.
void verify_against(const Options& options, nlohmann::ordered_json& j, std::string& text) {
    const std::vector<std::uint8_t> file = read_file(options.file), raw = read_file(options.against);
    Map map;
    try {
        decode_map(file.data(), file.size(), map);
    } catch (const Error& error) {
        throw Failure(options.file + ": " + error.text());
    }
    double found = 0;
    try {
        found = bake::rounding_error(map, bake::decode_raw(raw.data(), raw.size(), map));
    } catch (const Error& error) {
        throw Failure(options.against + ": " + error.text());
    }
    const auto stated = static_cast<double>(map.facts.quantisation_error);
    char line[160];
    if (!(found <= stated)) {
        std::snprintf(line, sizeof line, ": the map is off by %.4g %% of the peak force; it states %.4g %%",
                      100 * found, 100 * stated);
        throw Failure(options.file + line);
    }
    j["quantisation_error"] = found;
    j["quantisation_error_stated"] = stated;
    j["file_bytes"] = file.size();
    j["raw_bytes"] = raw.size();
    std::snprintf(line, sizeof line,
                  "; off by %.3g %% of the peak force, as stated; %.1f kB, the unrounded tables %.1f kB", 100 * found,
                  static_cast<double>(file.size()) / 1e3, static_cast<double>(raw.size()) / 1e3);
    text += line;
}

// Opening reads every chunk or block, checks the sums and the structure; what it accepts is sound.
void verify(const Options& options) {
    const Session session;
    nlohmann::ordered_json j{{"file", options.file}};
    std::string text;
    if (is_recording(options.file)) {
        if (!options.against.empty()) throw Failure("--against: " + options.file + " is a recording, not a map");
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
        if (!options.against.empty()) verify_against(options, j, text);
    }
    j["sound"] = true;
    if (options.json)
        std::printf("%s\n", j.dump(2).c_str());
    else
        std::printf("%s: sound (%s; checksums and structure)\n", options.file.c_str(), text.c_str());
}

CLI::App* add(CLI::App& app, const char* name, const char* help, const char* file, std::shared_ptr<Options> options,
              void (*run)(const Options&)) {
    CLI::App* command = app.add_subcommand(name, help);
    command->add_option("FILE", options->file, file)->required()->check(not_empty())->type_name("");
    command->add_flag("--json", options->json, "JSON on standard output");
    command->callback([options, run] { run(*options); });
    return command;
}

}  // namespace

void add_info(CLI::App& app) {
    add(app, "info", "Shows what a map holds and how it was made.", "a .frm map", std::make_shared<Options>(), info);
}

void add_verify(CLI::App& app) {
    auto options = std::make_shared<Options>();
    CLI::App* command =
        add(app, "verify", "Checks a map's or a recording's checksums and structure; exit status 1 if it is damaged.",
            "a .frm map or a recording", options, verify);
    command
        ->add_option("--against", options->against,
                     "the map's unrounded tables (.frmraw): exit status 1 if the map errs by more than it states")
        ->check(not_empty())
        ->type_name("RAW");
}

}  // namespace frm::cli
