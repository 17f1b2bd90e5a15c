#include "cli/bake_jobs.h"

#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "bake/tasks/durable.h"
#include "bake/tasks/mesh_copy.h"
#include "bake/tasks/plan_file.h"
#include "bake/tasks/rounds.h"
#include "bake/tasks/store.h"
#include "cli/bake_options.h"
#include "cli/bake_output.h"
#include "cli/bake_report.h"
#include "cli/file.h"
#include "cli/launcher.h"
#include "cli/progress.h"

namespace frm::cli {
namespace {

namespace fs = std::filesystem;

constexpr int status_missing = 3, status_extended = 4;

/// "0-3,7,9-11", which sbatch --array takes.
std::string ranges(const std::vector<std::size_t>& numbers) {
    std::string text;
    for (std::size_t i = 0; i < numbers.size();) {
        std::size_t j = i;
        while (j + 1 < numbers.size() && numbers[j + 1] == numbers[j] + 1) ++j;
        text += (text.empty() ? "" : ",") + std::to_string(numbers[i]);
        if (j > i) text += "-" + std::to_string(numbers[j]);
        i = j + 1;
    }
    return text;
}

// ---- plan ------------------------------------------------------------------------------------------------------

struct PlanOptions {
    BakeArguments arguments;
    std::string folder;
    bool json = false;
};

void plan(PlanOptions& o) {
    settle_unit(o.arguments);
    const bake::BakePlan plan = make_plan(o.arguments, o.folder);
    bake::Store store(o.folder, plan, print_note);
    bake::copy_mesh(o.arguments.bake.mesh, o.folder);
    print_plan(plan);
    std::vector<std::size_t> missing;
    for (std::size_t k = 0; k < plan.tasks.size(); ++k)
        if (bake::TaskResult result; !store.load(k, plan.tasks[k], result)) missing.push_back(k);
    if (!o.json) {
        std::printf("%s: %zu tasks, %zu of them to be solved\n", o.folder.c_str(), plan.tasks.size(), missing.size());
        return;
    }
    const Cost cost = cost_of(plan);
    const nlohmann::ordered_json j{{"folder", o.folder},           {"tasks", plan.tasks.size()},
                                   {"missing", ranges(missing)},   {"updates", cost.updates},
                                   {"bytes_each", cost.bytes},     {"directions", plan.directions.count()},
                                   {"sources", plan.regions.count}};
    std::printf("%s\n", j.dump(2).c_str());
}

// ---- What solve and merge begin with -----------------------------------------------------------------------------

struct Folder {
    std::size_t known = 0;  ///< tasks that were asked for so far
    bake::BakePlan plan;
    std::unique_ptr<bake::Store> store;
};

Folder open_folder(const std::string& path) {
    std::vector<std::uint8_t> bytes;
    const std::string file = path + "/plan.json";
    if (!bake::read_whole(file, 1 << 20, bytes))
        throw Failure(path + ": has no plan.json; frm bake plan MESH -o DIR makes one");
    const bake::PlanFile said = bake::parse_plan(std::string(bytes.begin(), bytes.end()), file);
    bake::BakeOptions options = said.options;
    options.mesh = bake::mesh_in(path, said.options.mesh);
    std::error_code error;
    if (!fs::exists(options.mesh, error))
        throw Failure(options.mesh + ": is not there. (The folder of a bake on one machine has no mesh.)");
    Folder folder;
    folder.known = said.tasks;
    folder.plan = bake::plan_bake(options);
    if (bake::fingerprint_of(folder.plan) != said.fingerprint)
        throw Failure(path +
                      ": this machine's frm comes to another plan than the one that wrote plan.json, or the "
                      "mesh was changed; plan again");
    folder.store = std::make_unique<bake::Store>(path, folder.plan, print_note);
    return folder;
}

// ---- solve -----------------------------------------------------------------------------------------------------

struct SolveOptions {
    std::string folder;
    long task = -1;
    int threads = 0;
};

void solve(SolveOptions& o) {
    const Launched here = launched();
    if (o.task < 0) o.task = here.task;
    Folder folder = open_folder(o.folder);
    bake::BakePlan& plan = folder.plan;
    std::vector<std::size_t> which;
    if (o.task < 0 || static_cast<std::size_t>(o.task) >= plan.tasks.size()) {
        // Tasks of later rounds follow from the results of those before.
        const bake::Found found = bake::find_rounds(plan, *folder.store, folder.known);
        which = found.missing;
    }
    if (o.task >= 0) {
        if (static_cast<std::size_t>(o.task) >= plan.tasks.size())
            throw Failure("--task " + std::to_string(o.task) + ": " + o.folder + " has tasks 0 to " +
                          std::to_string(plan.tasks.size() - 1) +
                          (which.empty() ? "" : "; " + ranges(which) + " must be solved before there can be more"));
        which.assign(1, static_cast<std::size_t>(o.task));
    }
    // Processes that start together begin apart from each other.
    std::rotate(which.begin(), which.begin() + static_cast<std::ptrdiff_t>(which.size() * here.rank / here.ranks),
                which.end());

    bake::RunSettings settings;
    settings.threads = o.threads;
    if (settings.threads == 0 && here.threads > 0) settings.threads = std::min(here.threads, omp_get_max_threads());
    settings.store = folder.store.get();
    settings.wait = false;
    settings.part = true;
    std::size_t solved = 0, found = 0;
    ProgressBar bar("solve");
    try {
        bake::run_tasks(
            plan.surface, plan.patches, plan.tasks, which, settings,
            [&](const bake::RunState& state) {
                return bar.update(state.share, state.seconds_left, bake::text_of(state));
            },
            [&](std::size_t k, bake::TaskResult&& result, bool here_now) {
                ++(here_now ? solved : found);
                if (!here_now) return;
                bar.hide();
                std::printf("task %zu (%s): done in %.1f s\n", k, plan.tasks[k].name.c_str(), result.seconds);
                std::fflush(stdout);
            });
    } catch (const bake::FlowCancelled&) {
        throw Failure("interrupted; what was finished is kept in " + o.folder);
    }
    bar.hide();
    const std::size_t left = which.size() - solved - found;
    if (found) std::fprintf(stderr, "%zu task%s there already\n", found, found == 1 ? " was" : "s were");
    if (left)
        std::fprintf(stderr, "%zu task%s left to the process%s at it\n", left, left == 1 ? " is" : "s are",
                     left == 1 ? " that is" : "es that are");
}

// ---- merge -----------------------------------------------------------------------------------------------------

struct MergeOptions {
    std::string folder, out, raw, report;
    bool force = false, json = false;
};

void merge(MergeOptions& o) {
    const bool named = !o.out.empty();
    std::vector<std::string> outputs = BakePage::files(o.report);
    outputs.insert(outputs.end(), {o.out, o.raw, o.report});
    require_distinct(outputs, {});
    require_raw_place(o.raw, o.force);
    if (named) require_map_place(o.out, named, o.force);
    Folder folder = open_folder(o.folder);
    if (!named) {
        o.out = default_map(folder.plan.options.mesh);
        require_map_place(o.out, named, o.force);
    }
    const bake::Found found = bake::find_rounds(folder.plan, *folder.store, folder.known);
    const std::size_t all = folder.plan.tasks.size(), missing = found.missing.size();
    if (missing) {
        std::printf("%s\n", ranges(found.missing).c_str());
        std::fflush(stdout);
        if (found.extended)
            std::fprintf(stderr,
                         "frm bake merge: the results ask for %zu more tasks (%zu in all); %zu to be solved: %s\n",
                         all - folder.known, all, missing, ranges(found.missing).c_str());
        else
            std::fprintf(stderr, "frm bake merge: %zu of %zu tasks are not solved: %s\n", missing, all,
                         ranges(found.missing).c_str());
        throw Unsuccessful{found.extended ? status_extended : status_missing};
    }
    const std::unique_ptr<BakePage> page =
        o.report.empty() ? nullptr : std::make_unique<BakePage>(o.report, std::vector<std::string>{o.out, o.raw});
    BakeRun done;
    done.json = o.json;
    done.raw = o.raw;
    done.page = page.get();
    for (const bake::TaskResult& result : found.results) done.seconds += result.seconds;
    finish_map(folder.plan, found.results, o.out, done);
    if (page) end_report(*page, o.report, o.json);
}

// ---- The commands ------------------------------------------------------------------------------------------------

void add_folder(CLI::App& command, std::string& folder) {
    command.add_option("DIR", folder, "a folder that frm bake plan wrote")
        ->required()
        ->check(not_empty())
        ->type_name("");
}

void add_plan(CLI::App& bake) {
    auto options = std::make_shared<PlanOptions>();
    PlanOptions& o = *options;
    CLI::App* command = bake.add_subcommand("plan", "Writes a folder of tasks that can be solved anywhere.");
    command->footer(
        "The folder holds all that solve and merge need, the mesh too; it may be moved or copied.\n"
        "  frm bake plan paddle.glb -o jobs --quality high\n"
        "A mesh file named plan, solve or merge is ./plan to frm bake.");
    add_bake_arguments(*command, o.arguments, true);
    command->add_option("-o,--out", o.folder, "the folder")->required()->check(not_empty())->type_name("DIR");
    command->add_flag("--json", o.json, "JSON on standard output");
    command->callback([options, command] {
        complete(*command, options->arguments);
        plan(*options);
    });
}

void add_solve(CLI::App& bake) {
    auto options = std::make_shared<SolveOptions>();
    SolveOptions& o = *options;
    CLI::App* command = bake.add_subcommand("solve", "Solves tasks of a folder: one, or what nobody else is at.");
    command->footer(
        "Any number may run at once, here and on other machines; a task that was lost is solved\n"
        "again by whoever comes next. Status 0 also if there was nothing left to do.\n"
        "  sbatch --array=0-37 --cpus-per-task=4 --wrap 'frm bake solve jobs'\n"
        "  mpirun -n 4 frm bake solve jobs");
    add_folder(*command, o.folder);
    command
        ->add_option("--task", o.task,
                     "its number, from 0 (default: SLURM_ARRAY_TASK_ID; without it all tasks that\n"
                     "are not solved and that no other process is at)")
        ->check(whole_within(0, 1000000))
        ->type_name("K");
    command
        ->add_option("--threads", o.threads,
                     "0: the cores that Slurm or MPI's launcher gives, else all. Results do not\ndepend on it")
        ->check(whole_within(0, 256))
        ->type_name("N")
        ->capture_default_str();
    command->callback([options] { solve(*options); });
}

void add_merge(CLI::App& bake) {
    auto options = std::make_shared<MergeOptions>();
    MergeOptions& o = *options;
    CLI::App* command = bake.add_subcommand("merge", "Makes the map of a folder whose tasks are solved.");
    command->footer(
        "Exit status: 0 the map is written; 3 tasks are not solved; 4 the results ask for more\n"
        "tasks, which the folder has now; 1 failed, 2 wrong arguments. With 3 and 4 the numbers are\n"
        "on standard output as sbatch --array takes them:\n"
        "  until tasks=$(frm bake merge jobs -o paddle.frm); do\n"
        "      [ $? -ge 3 ] || exit 1\n"
        "      sbatch --wait --array=\"$tasks\" --wrap 'frm bake solve jobs' || exit 1\n"
        "  done");
    add_folder(*command, o.folder);
    command
        ->add_option("-o,--out", o.out,
                     "the map to write (default: the mesh's name, .frm, in the current folder, if\nthere is none yet)")
        ->check(not_empty())
        ->type_name("FILE");
    add_raw_option(*command, o.raw);
    add_report_option(*command, o.report);
    command->add_flag("--force", o.force, "replace a file that is not a map, or was not named by -o");
    command->add_flag("--json", o.json, "JSON on standard output");
    command->callback([options] { merge(*options); });
}

}  // namespace

void add_bake_jobs(CLI::App& bake) {
    add_plan(bake);
    add_solve(bake);
    add_merge(bake);
    for (CLI::App* command : bake.get_subcommands({})) command->group("On many machines");
}

}  // namespace frm::cli
