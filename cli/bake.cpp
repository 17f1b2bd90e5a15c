// frm bake: from a mesh to a map on this machine.
#include "bake/bake.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "bake/tasks/rounds.h"
#include "bake/tasks/store.h"
#include "cli/bake_jobs.h"
#include "cli/bake_options.h"
#include "cli/bake_output.h"
#include "cli/bake_report.h"
#include "cli/file.h"
#include "cli/progress.h"

namespace frm::cli {
namespace {

namespace fs = std::filesystem;

struct Options {
    BakeArguments arguments;
    std::string out, work, raw, report;
    bool named = false, force = false, keep = false, json = false;
};

std::string kept_text(const bake::Store& store, const bake::BakePlan& plan) {
    const std::size_t kept = store.count(plan.tasks.size());
    return std::to_string(kept) + " of " + std::to_string(plan.tasks.size()) + " flows are kept in " + store.folder();
}

/// Ends a bake that did not come to its map. The flows that are done stay for the same command. `root`: the folder above
/// the store's, if it is ours.
[[noreturn]] void leave(bake::Store& store, const bake::BakePlan& plan, const std::string& root,
                        const std::string& why) {
    if (store.count(plan.tasks.size()) == 0) {
        store.remove();
        if (!root.empty()) rmdir(root.c_str());
        throw Failure(why + "; no flow was finished, nothing was written");
    }
    throw Failure(why + "; " + kept_text(store, plan) + ", the same command goes on from there");
}

/// After the map is written.
void clear(bake::Store& store, const std::string& root, bool keep) {
    if (keep) {
        std::fprintf(stderr, "the flows are kept in %s\n", store.folder().c_str());
        return;
    }
    store.remove();
    if (root.empty() || rmdir(root.c_str()) == 0) return;
    std::error_code error;
    std::size_t others = 0;
    for (fs::directory_iterator entry(root, error), end; !error && entry != end; entry.increment(error))
        others += fs::exists(entry->path() / "plan.json") && entry->path() != fs::path(store.folder()) ? 1 : 0;
    if (others)
        print_note(root + " has flows of " + std::to_string(others) + " unfinished bake" + (others == 1 ? "" : "s") +
                   " with other options; remove it if they are not wanted");
}

/// Cell updates of the tasks that are not done.
double to_do(const bake::Store& store, const bake::BakePlan& plan) {
    double updates = 0;
    for (std::size_t k = 0; k < plan.tasks.size(); ++k)
        if (!store.has(k)) updates += plan.tasks[k].cost.updates;
    return updates;
}

void run(Options& o) {
    bake::BakeOptions& options = o.arguments.bake;
    const std::string root = o.work.empty() ? o.out + ".work" : "";
    std::vector<std::string> outputs = BakePage::files(o.report);
    outputs.insert(outputs.end(), {o.out, o.raw, o.report, o.work, root});
    require_distinct(outputs, {options.mesh});
    require_map_place(o.out, o.named, o.force);
    require_raw_place(o.raw, o.force);
    settle_unit(o.arguments);
    bake::BakePlan plan = make_plan(o.arguments, o.out);
    const std::unique_ptr<BakePage> page =
        o.report.empty() ? nullptr
                         : std::make_unique<BakePage>(o.report, std::vector<std::string>{o.out, o.raw, o.work, root});
    print_plan(plan);

    bake::Store store(bake::work_folder(root.empty() ? o.work : root, plan), plan, print_note);
    if (store.count(plan.tasks.size()) > 0) std::fprintf(stderr, "going on: %s\n", kept_text(store, plan).c_str());

    const double before = cost_of(plan).updates - to_do(store, plan);
    const auto begin = std::chrono::steady_clock::now();
    // It holds Ctrl-C back until the map is written whole.
    ProgressBar bar("bake");
    try {
        bake::RunSettings settings;
        settings.threads = options.threads;
        settings.store = &store;
        const std::vector<bake::TaskResult> results =
            bake::solve_rounds(plan, settings, [&](const bake::RunState& state) {
                return bar.update(state.share, state.seconds_left, bake::text_of(state));
            });
        bar.update(1, -1, "making the map");
        BakeRun done;
        done.json = o.json;
        done.raw = o.raw;
        done.page = page.get();
        done.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
        done.updates = cost_of(plan).updates - before;
        finish_map(plan, results, o.out, done, [&] { bar.hide(); });
    } catch (const bake::FlowCancelled&) {
        bar.hide();
        leave(store, plan, root, "interrupted");
    } catch (const std::bad_alloc&) {
        bar.hide();
        leave(store, plan, root, "out of memory");
    } catch (const std::exception& error) {
        bar.hide();
        leave(store, plan, root, error.what());
    }
    clear(store, root, o.keep);
    if (page) end_report(*page, o.report, o.json);
}

}  // namespace

void add_bake(CLI::App& app) {
    auto options = std::make_shared<Options>();
    Options& o = *options;
    CLI::App* command = app.add_subcommand(
        "bake", "Solves the flow around an object from many directions and stores the forces as a map.");
    command->footer(
        "The mesh is a closed glTF surface; its frame is the map's, its unit the metre (--scale).\n"
        "Each flow that is finished is kept in OUT.work until the map is there: after Ctrl-C, a\n"
        "full disk or a power cut the same command goes on where it was, and two of the same at\n"
        "once share the work. plan, solve and merge do the same on many machines.\n"
        "  frm bake paddle.glb\n"
        "  frm bake paddle.glb -o out/paddle.frm --quality draft");
    // Not required by CLI11, which would ask plan, solve and merge for it too.
    add_bake_arguments(*command, o.arguments, false);
    command
        ->add_option("-o,--out", o.out,
                     "the map to write; it appears whole or not at all (default: the mesh's name,\n"
                     ".frm, in the current folder, if there is none yet)")
        ->check(not_empty())
        ->type_name("FILE");
    add_raw_option(*command, o.raw);
    add_report_option(*command, o.report);
    command->add_flag("--force", o.force, "replace a file that is not a map, or was not named by -o");
    command->add_option("--work", o.work, "folder for unfinished work (default: OUT.work)")
        ->check(not_empty())
        ->type_name("DIR");
    command->add_flag("--keep", o.keep, "keep the finished flows when the map is written");
    command->add_option("--threads", o.arguments.bake.threads, "0: all cores. The map does not depend on it")
        ->check(whole_within(0, 256))
        ->type_name("N")
        ->capture_default_str();
    command->add_flag("--json", o.json, "JSON on standard output");
    add_bake_jobs(*command);
    // Before plan, solve or merge runs: what stands left of them would be passed over.
    command->parse_complete_callback([command] {
        if (command->get_subcommands().empty()) return;
        for (const CLI::Option* option : command->get_options())
            if (option->count() > 0)
                throw CLI::ExtrasError(
                    {option->get_name() + ": belongs after " + command->get_subcommands().front()->get_name()});
    });
    command->callback([options, command] {
        if (!command->get_subcommands().empty()) return;  // it has run
        if (options->arguments.bake.mesh.empty()) throw CLI::RequiredError("MESH");
        complete(*command, options->arguments);
        options->named = !options->out.empty();
        if (!options->named) options->out = default_map(options->arguments.bake.mesh);
        run(*options);
    });
}

}  // namespace frm::cli
