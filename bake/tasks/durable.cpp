#include "bake/tasks/durable.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>

namespace frm::bake {
namespace {

[[noreturn]] void fail(const std::string& path, int error) { throw FileError(path + ": " + std::strerror(error)); }

/// Closed at the end of its scope; close() tells what the system says of it (a full network disk may say so only then).
class Descriptor {
public:
    explicit Descriptor(int number) : number_(number) {}
    ~Descriptor() { close(); }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int number() const { return number_; }
    int close() {
        const int number = number_;
        number_ = -1;
        return number >= 0 ? ::close(number) : 0;
    }

private:
    int number_;
};

int write_all(int file, const unsigned char* data, std::size_t size) {
    while (size > 0) {
        const ssize_t written = write(file, data, size);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) return written == 0 ? ENOSPC : errno;
        data += written;
        size -= static_cast<std::size_t>(written);
    }
    return 0;
}

// A process of another host may have the same number, and a library two bakes: the time tells them apart.
std::string temporary_name(const std::string& path) {
    static std::atomic<unsigned> count{0};
    timespec now{};
    clock_gettime(CLOCK_REALTIME, &now);
    return path + ".tmp." + std::to_string(getpid()) + "-" + std::to_string(now.tv_nsec) + "-" +
           std::to_string(count.fetch_add(1));
}

}  // namespace

void write_durably(const std::string& path, const void* data, std::size_t size) {
    struct stat there {};
    if (stat(path.c_str(), &there) == 0 && !S_ISREG(there.st_mode))
        throw FileError(path + ": is not an ordinary file; nothing is written there");
    const std::string temporary = temporary_name(path);
    Descriptor file(open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666));
    if (file.number() < 0) fail(path, errno);
    int error = write_all(file.number(), static_cast<const unsigned char*>(data), size);
    if (!error && fsync(file.number()) != 0) error = errno;
    if (file.close() != 0 && !error) error = errno;
    if (!error && rename(temporary.c_str(), path.c_str()) != 0) error = errno;
    if (error) {
        unlink(temporary.c_str());
        fail(path, error);
    }
    // The new name too must be on the disk. File systems that cannot do this for a folder say so; nothing is lost.
    const std::string parent = std::filesystem::path(path).parent_path().string();
    Descriptor folder(open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (folder.number() >= 0) fsync(folder.number());
}

bool read_whole(const std::string& path, std::uint64_t most, std::vector<std::uint8_t>& bytes) {
    // Not blocking: a pipe by this name would wait for a writer for ever.
    Descriptor file(open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
    if (file.number() < 0) {
        if (errno == ENOENT) return false;
        fail(path, errno);
    }
    struct stat about {};
    if (fstat(file.number(), &about) != 0) fail(path, errno);
    if (!S_ISREG(about.st_mode)) throw FileError(path + ": is not an ordinary file");
    const auto size = static_cast<std::uint64_t>(about.st_size);
    if (size > most) throw FileError(path + ": is too large to be what its name says");
    bytes.resize(static_cast<std::size_t>(size));
    std::size_t at = 0;
    while (at < bytes.size()) {
        const ssize_t got = read(file.number(), bytes.data() + at, bytes.size() - at);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) fail(path, errno);
        if (got == 0) break;
        at += static_cast<std::size_t>(got);
    }
    bytes.resize(at);
    return true;
}

void make_folders(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error) throw FileError(path + ": " + error.message());
    if (!std::filesystem::is_directory(path, error)) fail(path, ENOTDIR);
}

}  // namespace frm::bake
