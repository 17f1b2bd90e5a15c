// Files that outlive a killed process, a full disk and a power cut: whole or not there.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bake/error.h"

namespace frm::bake {

/// A file could not be read or written; the text names it and says why.
class FileError : public BakeError {
public:
    using BakeError::BakeError;
};

/// Writes to `path`.tmp.<process>, makes sure that it is on the disk, and renames it. Where that fails nothing is left
/// and an older file stays as it was. Throws FileError.
void write_durably(const std::string& path, const void* data, std::size_t size);

/// False if there is no such file. Throws FileError where it cannot be read or has more than `most` bytes.
bool read_whole(const std::string& path, std::uint64_t most, std::vector<std::uint8_t>& bytes);

/// With its parents. Throws FileError.
void make_folders(const std::string& path);

}  // namespace frm::bake
