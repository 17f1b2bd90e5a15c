#include "cli/report.h"

#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "cli/command.h"
#include "frm.h"

namespace frm::cli {
namespace {

namespace fs = std::filesystem;

/// The library that this program runs with, so that the page is drawn with the same one.
std::string library_path() {
    Dl_info info{};
    if (dladdr(reinterpret_cast<const void*>(&frm_version), &info) == 0 || !info.dli_fname)
        throw Failure("libfrm's own path is not known");
    return fs::canonical(info.dli_fname).string();
}

/// Installed: ../share/frm/python beside the program; in a build tree: the source's.
std::string package_path() {
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    if (!error) {
        const fs::path installed = program.parent_path().parent_path() / "share" / "frm" / "python";
        if (fs::exists(installed / "frm" / "report.py")) return installed.string();
    }
    if (fs::exists(fs::path(FRM_PYTHON_SOURCE) / "frm" / "report.py")) return FRM_PYTHON_SOURCE;
    throw Failure("--report: the Python package of frm was not found (share/frm/python beside this program)");
}

int run_python(const std::vector<std::string>& arguments) {
    const pid_t child = fork();
    if (child < 0) throw Failure("--report: a process cannot be started");
    if (child == 0) {
        // Ctrl-C ends what is computed, not the page of it: drawing takes seconds, and without the page all would be lost.
        std::signal(SIGINT, SIG_IGN);
        // Standard output is the caller's: --json must be alone there.
        if (!freopen("/dev/null", "w", stdout)) _exit(127);
        setenv("PYTHONPATH", package_path().c_str(), 1);
        setenv("FRM_LIBRARY", library_path().c_str(), 1);
        setenv("PYTHONDONTWRITEBYTECODE", "1", 1);
        std::vector<char*> argv{const_cast<char*>(FRM_PYTHON)};
        for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
        argv.push_back(nullptr);
        execv(FRM_PYTHON, argv.data());
        _exit(127);
    }
    int status = 0;
    while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

}  // namespace

std::string missing_report_tools() {
    package_path();
    library_path();
    if (run_python({"-c", "import sys\ntry:\n import matplotlib\nexcept ImportError:\n sys.exit(3)"}) != 0)
        return FRM_PYTHON " with matplotlib is needed: apt install python3-matplotlib";
    return "";
}

void require_report_tools() {
    const std::string missing = missing_report_tools();
    if (!missing.empty()) throw Failure("--report: " + missing + ". Without --report the run needs neither");
}

std::string report_command(const std::string& module, const std::string& folder) {
    return "PYTHONPATH='" + package_path() + "' " FRM_PYTHON " -m " + module + " '" + folder + "'";
}

void write_report(const std::string& recording, const std::string& run_json, const std::string& page) {
    if (run_python({"-m", "frm.report", recording, "-o", page, "--run", run_json}) != 0)
        throw Failure("--report: the page was not written");
}

void write_bake_page(const std::string& folder) {
    if (run_python({"-m", "frm.bake_report", folder}) != 0) throw Failure("it could not be drawn");
}

void write_flow_page(const std::string& folder) {
    if (run_python({"-m", "frm.flow_report", folder}) != 0) throw Failure("--report: the page was not written");
}

}  // namespace frm::cli
