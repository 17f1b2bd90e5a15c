// Locks between processes that share a folder. They belong to the kernel: one that dies, however, gives them back.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace frm::bake {

/// A file whose bytes are locks, numbered from 0. Locks of two LockFiles exclude each other also within one process.
///
/// Some cluster file systems have no locks. Every lock is then given, exclusive() is not; what is computed stays right
/// (results are the same bytes and appear by rename), only work is done twice.
class LockFile {
public:
    /// Makes the file if need be, and takes a place among its users. Throws FileError.
    explicit LockFile(const std::string& path);
    ~LockFile();
    LockFile(const LockFile&) = delete;
    LockFile& operator=(const LockFile&) = delete;

    bool work() const { return work_; }
    /// Never waits. A lock that this LockFile has already is given again.
    bool try_lock(std::uint64_t number);
    void unlock(std::uint64_t number);
    /// True if nobody else uses the file; whoever comes now waits until this LockFile is gone, and then finds that the
    /// file is not this one any more, if that was removed.
    bool exclusive();

private:
    bool control(int command, short type, std::uint64_t byte);

    int file_ = -1;
    std::atomic<bool> work_{true};
};

}  // namespace frm::bake
