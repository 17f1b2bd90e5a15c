// The folder where a bake keeps what is done, and where processes share it:
//
//   plan.json         what the folder belongs to
//   task-00012.flow   a result (result_file.h)
//   locks             who works at what (locks.h)
//   mesh/             a copy of the mesh, where the folder was planned to be worked on elsewhere (mesh_copy.h)
//
// Results appear whole. Nothing else has to be written for a process to be killed at any time.
#pragma once

#include <functional>
#include <mutex>
#include <string>

#include "bake/bake.h"
#include "bake/tasks/locks.h"

namespace frm::bake {

class Store {
public:
    /// Told what the user should know, such as that a file was damaged; from any thread, not from two at once.
    using Note = std::function<void(const std::string&)>;

    /// Makes the folder or joins those who use it. Throws FileError, also if it belongs to another plan. The plan must
    /// not be extended yet.
    Store(std::string folder, const BakePlan& plan, Note note = nullptr);

    const std::string& folder() const { return folder_; }

    /// Whether there is a file for the task; not whether it is sound.
    bool has(std::size_t number) const;
    /// How many of the tasks have one.
    std::size_t count(std::size_t tasks) const;

    /// Reads a result. False if there is none, or none that is sound and of this task; that is noted.
    bool load(std::size_t number, const Task& task, TaskResult& result);

    enum class Claim {
        done,      ///< `result` was read
        ours,      ///< to be solved here; others leave it alone until save() or give_back()
        elsewhere  ///< another process is at it
    };
    /// Never waits.
    Claim claim(std::size_t number, const Task& task, TaskResult& result);
    void save(std::size_t number, const Task& task, const TaskResult& result);
    void give_back(std::size_t number);

    /// Writes down that the plan has so many tasks now.
    void set_tasks(const BakePlan& plan);

    /// Takes the folder away, unless another process uses it: then that one will. False if it stays.
    bool remove();

private:
    enum class Read { none, sound, unsound };
    Read read(std::size_t number, const Task& task, TaskResult& result, std::string& why) const;
    std::string path_of(std::size_t number) const;
    void remove_leftovers(std::size_t number) const;
    void note(const std::string& text);

    std::string folder_, fingerprint_;
    std::uint64_t body_;
    std::uint32_t patches_;
    Note note_;
    std::mutex note_lock_;
    std::unique_ptr<LockFile> locks_;
};

/// The folder of unfinished work for an output file: OUT.work/FINGERPRINT, so that different options never take each
/// other's hours.
std::string work_folder(const std::string& root, const BakePlan& plan);

}  // namespace frm::bake
