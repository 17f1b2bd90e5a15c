// Files by their UTF-8 names, which the C library of Windows does not take.
#pragma once

#include <cstdio>

namespace frm {

/// fopen: null, and errno says why.
std::FILE* open_file(const char* path, const char* mode);

/// rename, in place of a file that is there: 0, or an errno.
int replace_file(const char* from, const char* to);

}  // namespace frm
