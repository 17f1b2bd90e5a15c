// Threads of the library's own, and what a machine without them gives.
#pragma once

#include <system_error>
#include <thread>
#include <utility>

#include "core/error.h"

namespace frm::device {

/// WebAssembly has them only where it is built for them (-pthread).
#if defined(__EMSCRIPTEN__) && !defined(__EMSCRIPTEN_PTHREADS__)
inline constexpr bool has_threads = false;
#else
inline constexpr bool has_threads = true;
#endif

/// `whose`, for the text: "the servo". Throws Error: FRM_ERROR_UNSUPPORTED where there are no threads, FRM_ERROR_LIMIT
/// where the system has none left.
template <typename Run>
std::thread start_thread(const char* whose, Run&& run) {
    if (!has_threads)
        throw Error(FRM_ERROR_UNSUPPORTED, "%s needs a thread of its own, and this libfrm was built without threads",
                    whose);
    try {
        return std::thread(std::forward<Run>(run));
    } catch (const std::system_error& error) {
        throw Error(FRM_ERROR_LIMIT, "%s needs a thread of its own, which cannot be started: %s", whose, error.what());
    }
}

}  // namespace frm::device
