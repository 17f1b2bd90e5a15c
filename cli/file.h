// Output files appear whole or not at all.
#pragma once

#include <cstddef>
#include <string>

namespace frm::cli {

/// Writes a neighbour file first and then renames it. Throws Failure naming the path; an older file stays as it was.
void write_file(const std::string& path, const void* data, std::size_t size);
inline void write_file(const std::string& path, const std::string& text) { write_file(path, text.data(), text.size()); }

/// Throws Failure now if the file could not be written after an hour's work.
void require_writable(const std::string& path);

void make_folder(const std::string& path);

}  // namespace frm::cli
