#include "cli/report_folder.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <fstream>
#include <iterator>
#include <system_error>

#include "cli/command.h"

namespace frm::cli {
namespace {

namespace fs = std::filesystem;

const std::string temporary_name = ".frm_report.tmp";  // and the process's number

bool is_temporary(const fs::path& path) { return path.filename().string().rfind(temporary_name, 0) == 0; }

/// What a process that was killed left there.
void remove_left_over(const fs::path& folder) {
    std::error_code ignored;
    std::vector<fs::path> old;
    for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
        if (!is_temporary(entry->path())) continue;
        const std::string name = entry->path().filename().string();
        pid_t process = 0;
        const char* const last = name.data() + name.size();
        if (std::from_chars(name.data() + temporary_name.size(), last, process).ptr != last || process <= 0) continue;
        if (kill(process, 0) != 0 && errno == ESRCH) old.push_back(entry->path());
    }
    for (const fs::path& path : old) fs::remove_all(path, ignored);
}

/// Whether the path is one of them, or a folder above one.
bool holds_one_of(const std::vector<std::string>& others, const fs::path& path) {
    return std::any_of(others.begin(), others.end(), [&](const std::string& other) {
        std::error_code error;
        const fs::path whole = other.empty() ? fs::path() : fs::weakly_canonical(fs::absolute(other), error);
        return !error && std::mismatch(path.begin(), path.end(), whole.begin(), whole.end()).first == path.end();
    });
}

[[noreturn]] void fail(const fs::path& path, const std::error_code& error) {
    throw Failure("--report: " + path.string() + ": " + error.message());
}

}  // namespace

/// An empty folder, or a report of this kind and nothing else; what other runs are at, and the other outputs, do not count.
bool ReportFolder::may_be_replaced(const std::vector<std::string>& others) const {
    bool empty = true;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
        if (is_temporary(entry.path()) || holds_one_of(others, entry.path())) continue;
        empty = false;
        if (std::count(kind_.files.begin(), kind_.files.end(), entry.path().filename().string()) == 0) return false;
    }
    if (empty) return true;
    std::ifstream file(folder_ / kind_.files.front(), std::ios::binary);
    const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    return text.find(kind_.format) != std::string::npos;
}

ReportFolder::ReportFolder(const std::string& folder, ReportKind kind, const std::vector<std::string>& others)
    : kind_(std::move(kind)) {
    std::error_code error;
    folder_ = fs::weakly_canonical(fs::absolute(folder), error);
    if (error) fail(folder, error);
    const bool there = fs::exists(folder_, error);
    if (there && !fs::is_directory(folder_, error)) throw Failure("--report: " + folder + ": is not a folder");
    try {
        if (there && !may_be_replaced(others))
            throw Failure("--report: " + folder + ": holds other files; name a new or an empty folder");
    } catch (const fs::filesystem_error& e) {
        fail(folder, e.code());
    }
    // Inside a folder that is there, because what is beside it may be another file system or somebody else's; beside
    // the topmost folder that is not there yet, so that a run that fails leaves none.
    fs::path where = folder_;
    while (!fs::exists(where, error)) where = where.parent_path();
    remove_left_over(where);
    temporary_ = where / (temporary_name + std::to_string(getpid()));
    if (!fs::create_directory(temporary_, error)) {
        temporary_.clear();
        fail(folder, error ? error : std::make_error_code(std::errc::file_exists));
    }
}

ReportFolder::~ReportFolder() {
    std::error_code ignored;
    if (!temporary_.empty()) fs::remove_all(temporary_, ignored);
}

void ReportFolder::publish() {
    std::error_code error;
    if (fs::exists(folder_, error)) {
        // The JSON, which says what the others hold, last.
        for (auto name = kind_.files.rbegin(); name != kind_.files.rend(); ++name) {
            if (fs::exists(temporary_ / *name, error))
                fs::rename(temporary_ / *name, folder_ / *name, error);
            else
                fs::remove(folder_ / *name, error);
            if (error) fail(folder_ / *name, error);
        }
        return;
    }
    fs::create_directories(folder_.parent_path(), error);
    if (!error) fs::rename(temporary_, folder_, error);
    if (error) fail(folder_, error);
    temporary_.clear();
}

std::vector<std::string> ReportFolder::paths(const std::string& folder, const ReportKind& kind) {
    std::vector<std::string> paths;
    for (const std::string& name : kind.files) paths.push_back(folder + "/" + name);
    return paths;
}

}  // namespace frm::cli
