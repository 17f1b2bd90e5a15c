#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "bake/flow/flow.h"
#include "cli/command.h"
#include "core/error.h"
#include "frm.h"

namespace {

/// Lets a solver's thread sleep while it waits for another: spinning, as libgomp does by itself, makes a bake ten times
/// slower once another program wants the processors. libgomp reads the variable when it is loaded, hence the second
/// start.
void let_threads_sleep(int argc, char** argv) {
    if (argc < 2 || (std::strcmp(argv[1], "bake") != 0 && std::strcmp(argv[1], "flow") != 0)) return;
    if (std::getenv("OMP_WAIT_POLICY") || std::getenv("GOMP_SPINCOUNT")) return;
    std::error_code error;
    const std::string program = std::filesystem::read_symlink("/proc/self/exe", error).string();
    if (error || setenv("OMP_WAIT_POLICY", "passive", 1) != 0) return;
    execv(program.c_str(), argv);
}

/// Who read standard output needs no word of it.
bool reader_is_gone() {
    pollfd output{STDOUT_FILENO, POLLOUT, 0};
    return poll(&output, 1, 0) == 1 && (output.revents & POLLERR) != 0;
}

void add_commands(CLI::App& app) {
    app.require_subcommand(1);
    app.get_formatter()->label("SUBCOMMAND", "COMMAND");
    app.get_formatter()->label("REQUIRED", "(required)");
    app.set_help_flag("-h,--help", "this text");
    app.set_version_flag("--version",
                         std::to_string(FRM_VERSION_MAJOR) + "." + std::to_string(FRM_VERSION_MINOR) + "." +
                             std::to_string(FRM_VERSION_PATCH),
                         "the version");
    frm::cli::add_mesh(app);
    frm::cli::add_bake(app);
    frm::cli::add_info(app);
    frm::cli::add_verify(app);
    frm::cli::add_flow(app);
    frm::cli::add_force(app);
    frm::cli::add_run(app);
    frm::cli::add_servo(app);
    frm::cli::add_replay(app);
    frm::cli::add_device(app);
    frm::cli::add_bench(app);
    for (CLI::App* command : app.get_subcommands({})) command->group("Commands");
}

}  // namespace

int main(int argc, char** argv) {
    let_threads_sleep(argc, argv);
    // Who reads standard output may go (frm flow ... | head) before a report is written: what is left to do is done.
    std::signal(SIGPIPE, SIG_IGN);
    CLI::App app{
        "frm - the force of water on moving rigid objects.\n\n"
        "  frm mesh paddle.glb                    is the mesh fit for it?\n"
        "  frm bake paddle.glb                    solve the flow around an object once: paddle.frm\n"
        "  frm info paddle.frm                    what the map holds\n"
        "  frm force paddle.frm --velocity 0,1,0  what it feels when it moves\n"
        "  frm run scene.json --report out        move it through water, and see\n\n"
        "Units are SI: m, s, kg, N. Each command has its own --help.\n"
        "Exit status: 0 good, 1 failed, 2 wrong arguments.\n",
        "frm"};
    add_commands(app);
    try {
        app.parse(frm::cli::arguments_of(argc, argv));
        const bool written = std::fflush(stdout) == 0;
        if (written && !std::ferror(stdout)) return 0;
        if (!reader_is_gone())
            std::fprintf(stderr, "frm: standard output: %s\n",
                         written ? "was not written whole" : std::strerror(errno));
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);
        std::fprintf(stderr, "%s\n", frm::cli::usage_error(app, error).c_str());
        return 2;
    } catch (const frm::cli::Unsuccessful& ending) {
        return ending.status;
    } catch (const frm::bake::FlowCancelled&) {
        std::fprintf(stderr, "frm: interrupted; nothing was written\n");
    } catch (const frm::Error& error) {
        std::fprintf(stderr, "frm: %s\n", error.text());
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "frm: out of memory\n");
    } catch (const std::exception& error) {
        std::fprintf(stderr, "frm: %s\n", error.what());
    }
    return 1;
}
