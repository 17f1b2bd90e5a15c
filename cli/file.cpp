#include "cli/file.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "cli/command.h"

namespace frm::cli {
namespace {

std::string neighbour(const std::string& path) { return path + ".tmp" + std::to_string(getpid()); }

[[noreturn]] void fail(const std::string& path, int error) { throw Failure(path + ": " + std::strerror(error)); }

}  // namespace

void write_file(const std::string& path, const void* data, std::size_t size) {
    const std::string temporary = neighbour(path);
    std::FILE* file = std::fopen(temporary.c_str(), "wb");
    if (!file) fail(path, errno);
    int error = 0;
    if (std::fwrite(data, 1, size, file) != size) error = errno;
    if (std::fclose(file) != 0 && !error) error = errno;
    if (!error && std::rename(temporary.c_str(), path.c_str()) != 0) error = errno;
    if (error) {
        std::remove(temporary.c_str());
        fail(path, error);
    }
}

void require_writable(const std::string& path) {
    if (std::filesystem::is_directory(path)) fail(path, EISDIR);
    const std::string temporary = neighbour(path);
    std::FILE* file = std::fopen(temporary.c_str(), "wb");
    if (!file) fail(path, errno);
    std::fclose(file);
    std::remove(temporary.c_str());
}

void make_folder(const std::string& path) {
    std::error_code error;
    std::filesystem::create_directories(path, error);
    if (error) throw Failure(path + ": " + error.message());
}

}  // namespace frm::cli
