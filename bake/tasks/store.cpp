#include "bake/tasks/store.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>

#include "bake/tasks/durable.h"
#include "bake/tasks/plan_file.h"
#include "bake/tasks/result_file.h"
#include "core/error.h"

namespace frm::bake {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t most_plan = 1 << 20, most_result = std::uint64_t{1} << 31;

bool starts_with(const std::string& text, const std::string& prefix) {
    return text.compare(0, prefix.size(), prefix) == 0;
}

bool ends_with(const std::string& text, const std::string& end) {
    return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

Store::Store(std::string folder, const BakePlan& plan, Note note)
    : folder_(std::move(folder)),
      fingerprint_(fingerprint_of(plan)),
      body_(hash_of_body(plan.surface, plan.patches)),
      patches_(plan.patches.count),
      note_(std::move(note)) {
    // Who has finished may take the folder away between the two lines; then once more.
    for (int tries = 0; !locks_; ++tries) {
        try {
            make_folders(folder_);
            locks_ = std::make_unique<LockFile>(folder_ + "/locks");
        } catch (const FileError&) {
            if (tries == 100) throw;  // a folder that is there now may not have been a moment ago
        }
    }
    if (!locks_->work())
        this->note(folder_ + ": this file system has no locks; two bakes at once would solve the same flows twice");
    const std::string path = folder_ + "/plan.json";
    std::vector<std::uint8_t> bytes;
    if (read_whole(path, most_plan, bytes)) {
        const std::string text(bytes.begin(), bytes.end());
        if (is_somebody_elses(text))
            throw FileError(path + ": is there and is not a plan of frm bake; name another folder");
        try {
            if (parse_plan(text, path).fingerprint == fingerprint_) return;
        } catch (const BakeError&) {
            // Results name what they are of, so that a lost plan loses nothing.
            this->note(path + ": was damaged or of another version; it is written again");
            bytes.clear();
        }
        if (!bytes.empty())
            throw FileError(folder_ +
                            ": belongs to another bake (mesh, options or version differ); name another folder");
    }
    set_tasks(plan);
}

void Store::set_tasks(const BakePlan& plan) {
    const std::string text = plan_text(plan, fingerprint_, plan.tasks.size());
    write_durably(folder_ + "/plan.json", text.data(), text.size());
}

std::string Store::path_of(std::size_t number) const {
    char name[32];
    std::snprintf(name, sizeof name, "/task-%05zu.flow", number);
    return folder_ + name;
}

void Store::note(const std::string& text) {
    const std::lock_guard<std::mutex> lock(note_lock_);
    if (note_) note_(text);
}

bool Store::has(std::size_t number) const { return access(path_of(number).c_str(), F_OK) == 0; }

std::size_t Store::count(std::size_t tasks) const {
    std::size_t count = 0;
    for (std::size_t k = 0; k < tasks; ++k) count += has(k) ? 1 : 0;
    return count;
}

Store::Read Store::read(std::size_t number, const Task& task, TaskResult& result, std::string& why) const {
    const std::string path = path_of(number);
    std::vector<std::uint8_t> bytes;
    try {
        if (!read_whole(path, most_result, bytes)) return Read::none;
        result = decode_result(bytes.data(), bytes.size(), key_of(body_, task.flow), patches_);
        return Read::sound;
    } catch (const Error& error) {
        why = path + ": " + error.text();
    } catch (const FileError& error) {
        why = error.what();
    }
    why += "; " + task.name + " is solved again";
    return Read::unsound;
}

bool Store::load(std::size_t number, const Task& task, TaskResult& result) {
    std::string why;
    const Read found = read(number, task, result, why);
    if (found == Read::unsound) note(why);
    return found == Read::sound;
}

Store::Claim Store::claim(std::size_t number, const Task& task, TaskResult& result) {
    std::string why;
    if (read(number, task, result, why) == Read::sound) return Claim::done;
    if (!locks_->try_lock(number)) return Claim::elsewhere;
    // It may have appeared while nobody had the lock.
    const Read found = read(number, task, result, why);
    if (found == Read::sound) {
        locks_->unlock(number);
        return Claim::done;
    }
    if (found == Read::unsound) {
        note(why);
        std::error_code ignored;
        fs::remove_all(path_of(number), ignored);
    }
    if (locks_->work()) remove_leftovers(number);
    return Claim::ours;
}

void Store::save(std::size_t number, const Task& task, const TaskResult& result) {
    const std::vector<std::uint8_t> bytes = encode_result(result, key_of(body_, task.flow));
    write_durably(path_of(number), bytes.data(), bytes.size());
    locks_->unlock(number);
}

void Store::give_back(std::size_t number) { locks_->unlock(number); }

/// Of a process that was killed while it wrote.
void Store::remove_leftovers(std::size_t number) const {
    const std::string prefix = fs::path(path_of(number)).filename().string() + ".tmp.";
    std::error_code error;
    for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error))
        if (starts_with(entry->path().filename().string(), prefix)) unlink(entry->path().c_str());
}

bool Store::remove() {
    if (!locks_->exclusive()) return false;
    std::error_code error;
    // Only what is ours: a file that somebody put there stays, and with it the folder.
    for (fs::directory_iterator entry(folder_, error), end; !error && entry != end; entry.increment(error)) {
        const std::string name = entry->path().filename().string();
        if ((starts_with(name, "task-") &&
             (ends_with(name, ".flow") || name.find(".flow.tmp.") != std::string::npos)) ||
            name == "plan.json" || starts_with(name, "plan.json.tmp."))
            unlink(entry->path().c_str());
    }
    unlink((folder_ + "/locks").c_str());
    locks_.reset();
    return rmdir(folder_.c_str()) == 0;
}

std::string work_folder(const std::string& root, const BakePlan& plan) { return root + "/" + fingerprint_of(plan); }

}  // namespace frm::bake
