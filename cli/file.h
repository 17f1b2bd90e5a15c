// Files, read whole; output files appear whole or not at all.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace frm::cli {

/// All of a file. Throws Failure naming the path.
std::vector<std::uint8_t> read_file(const std::string& path);

/// A file written under a neighbouring name, which commit() turns into its own; an older file stays as it was until
/// then. What is not committed is removed. Failures are thrown as Failure naming the path.
class OutputFile {
public:
    explicit OutputFile(const std::string& path);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    void write(const void* data, std::size_t size);
    void write(const std::string& text) { write(text.data(), text.size()); }
    void commit();

private:
    std::string path_, target_, temporary_;
    std::FILE* file_ = nullptr;
};

void write_file(const std::string& path, const void* data, std::size_t size);
inline void write_file(const std::string& path, const std::string& text) { write_file(path, text.data(), text.size()); }

/// Throws Failure now if the file could not be written after an hour's work.
void require_writable(const std::string& path);
/// Throws Failure if an output is an input, or two outputs are one file. Empty paths are passed over.
void require_distinct(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs);

void make_folder(const std::string& path);

}  // namespace frm::cli
