// Open file description locks (fcntl(2), F_OFD_SETLK): of the open file, not of the process, so that a thread that
// closes another descriptor of the same file does not lose them, as it would with the older POSIX locks.
#include "bake/tasks/locks.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "bake/tasks/durable.h"

// glibc shows them to _GNU_SOURCE only; the numbers are Linux's for every processor.
#ifndef F_OFD_SETLK
#define F_OFD_SETLK 37
#define F_OFD_SETLKW 38
#endif

namespace frm::bake {
namespace {

constexpr std::uint64_t users = 0, first = 1;  // bytes of the file; it stays empty, locks need no contents

}  // namespace

LockFile::LockFile(const std::string& path) {
    for (;;) {
        file_ = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (file_ < 0) throw FileError(path + ": " + std::strerror(errno));
        while (!control(F_OFD_SETLKW, F_RDLCK, users) && work_ && errno == EINTR) {
        }
        // Whoever had it for himself may have removed the file while we waited.
        struct stat ours {
        }, there{};
        if (fstat(file_, &ours) == 0 && stat(path.c_str(), &there) == 0 && ours.st_ino == there.st_ino &&
            ours.st_dev == there.st_dev)
            return;
        close(file_);
    }
}

LockFile::~LockFile() { close(file_); }

bool LockFile::control(int command, short type, std::uint64_t byte) {
    struct flock lock {};
    lock.l_type = type;
    lock.l_whence = SEEK_SET;
    lock.l_start = static_cast<off_t>(byte);
    lock.l_len = 1;
    if (fcntl(file_, command, &lock) == 0) return true;
    if (errno != EAGAIN && errno != EACCES && errno != EINTR && errno != EDEADLK) work_ = false;
    return false;
}

bool LockFile::try_lock(std::uint64_t number) {
    return !work_ || control(F_OFD_SETLK, F_WRLCK, first + number) || !work_;
}

void LockFile::unlock(std::uint64_t number) {
    if (work_) control(F_OFD_SETLK, F_UNLCK, first + number);
}

bool LockFile::exclusive() { return work_ && control(F_OFD_SETLK, F_WRLCK, users); }

}  // namespace frm::bake
