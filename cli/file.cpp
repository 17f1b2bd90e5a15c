#include "cli/file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "cli/command.h"

namespace frm::cli {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) { throw Failure(path + ": " + std::strerror(error)); }

/// Where a rename must lead: behind a link, so that the link stays. A device or pipe must not be replaced by a file.
std::string target_of(const std::string& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (fs::is_directory(status)) fail(path, EISDIR);
    if (!fs::exists(status)) return path;
    if (!fs::is_regular_file(status)) throw Failure(path + ": is not an ordinary file; nothing is written there");
    const fs::path target = fs::canonical(path, error);
    return error ? path : target.string();
}

bool same_file(const std::string& a, const std::string& b) {
    std::error_code error;
    const fs::path whole_a = fs::weakly_canonical(fs::absolute(a, error), error),
                   whole_b = fs::weakly_canonical(fs::absolute(b, error), error);
    return whole_a == whole_b || fs::equivalent(a, b, error);
}

}  // namespace

std::vector<std::uint8_t> read_file(const std::string& path) {
    std::error_code error;
    if (fs::is_directory(path, error)) fail(path, EISDIR);
    std::ifstream in(path, std::ios::binary);
    if (!in) fail(path, errno);
    std::vector<std::uint8_t> bytes{std::istreambuf_iterator<char>(in), {}};
    if (in.bad()) fail(path, EIO);
    return bytes;
}

OutputFile::OutputFile(const std::string& path)
    : path_(path), target_(target_of(path)), temporary_(target_ + ".tmp" + std::to_string(getpid())) {
    file_ = std::fopen(temporary_.c_str(), "wb");
    if (!file_) fail(path, errno);
}

OutputFile::~OutputFile() {
    if (!file_) return;
    std::fclose(file_);
    std::remove(temporary_.c_str());
}

void OutputFile::write(const void* data, std::size_t size) {
    if (std::fwrite(data, 1, size, file_) != size) fail(path_, errno);
}

void OutputFile::commit() {
    // On the disk before the name is: a power cut must not leave an empty file where an older one was.
    int error = std::fflush(file_) == 0 && fsync(fileno(file_)) == 0 ? 0 : errno;
    if (std::fclose(file_) != 0 && !error) error = errno;
    file_ = nullptr;
    if (!error && std::rename(temporary_.c_str(), target_.c_str()) != 0) error = errno;
    if (!error) return;
    std::remove(temporary_.c_str());
    fail(path_, error);
}

void write_file(const std::string& path, const void* data, std::size_t size) {
    OutputFile file(path);
    file.write(data, size);
    file.commit();
}

void require_writable(const std::string& path) { OutputFile file(path); }

void require_distinct(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        if (outputs[i].empty()) continue;
        for (const std::string& input : inputs)
            if (!input.empty() && same_file(outputs[i], input))
                throw Failure(outputs[i] + ": is read by this command; write to another file");
        for (std::size_t j = 0; j < i; ++j)
            if (!outputs[j].empty() && same_file(outputs[i], outputs[j]))
                throw Failure(outputs[i] + ": is named for two outputs");
    }
}

void make_folder(const std::string& path) {
    std::error_code error;
    fs::create_directories(path, error);
    if (error) throw Failure(path + ": " + error.message());
    if (!fs::is_directory(path, error)) fail(path, ENOTDIR);
}

}  // namespace frm::cli
