#include "core/file.h"

#include <cerrno>

#ifdef _WIN32
#define WIN32_LEAN_AND_MEAN
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <windows.h>

#include <string>
#endif

namespace frm {

#ifdef _WIN32
namespace {

std::wstring wide(const char* text) {
    const int size = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, text, -1, nullptr, 0);
    if (size <= 0) return {};
    std::wstring out(static_cast<std::size_t>(size), L'\0');
    MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, text, -1, out.data(), size);
    out.pop_back();  // the closing zero
    return out;
}

}  // namespace

std::FILE* open_file(const char* path, const char* mode) {
    const std::wstring name = wide(path);
    if (name.empty()) {
        errno = ENOENT;
        return nullptr;
    }
    return _wfopen(name.c_str(), wide(mode).c_str());
}

int replace_file(const char* from, const char* to) {
    if (MoveFileExW(wide(from).c_str(), wide(to).c_str(), MOVEFILE_REPLACE_EXISTING)) return 0;
    switch (GetLastError()) {
        case ERROR_FILE_NOT_FOUND:
        case ERROR_PATH_NOT_FOUND:
            return ENOENT;
        case ERROR_DISK_FULL:
            return ENOSPC;
        default:
            return EACCES;
    }
}
#else
std::FILE* open_file(const char* path, const char* mode) { return std::fopen(path, mode); }

int replace_file(const char* from, const char* to) { return std::rename(from, to) == 0 ? 0 : errno; }
#endif

}  // namespace frm
