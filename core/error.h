// The one exception of the run time. It never crosses the C ABI: core/api turns it into a status and the context's
// last-error text.
#pragma once

#include <cstdarg>
#include <cstdio>

#include "frm.h"

// mingw has two printfs; C++ has the standard's.
#if defined(__MINGW32__) && !defined(__clang__)
#define FRM_PRINTF gnu_printf
#else
#define FRM_PRINTF printf
#endif

namespace frm {

/// Holds its text itself, so that reporting an error needs no memory of the caller's allocator.
class Error {
public:
    [[gnu::format(FRM_PRINTF, 3, 4)]] Error(frm_status status, const char* format, ...) : status_(status) {
        va_list arguments;
        va_start(arguments, format);
        std::vsnprintf(text_, sizeof text_, format, arguments);
        va_end(arguments);
    }

    frm_status status() const { return status_; }
    const char* text() const { return text_; }

private:
    frm_status status_;
    char text_[400];
};

}  // namespace frm
