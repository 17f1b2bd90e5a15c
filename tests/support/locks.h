// Every lock that the program takes which this is linked into, counted.
#pragma once

#include <atomic>
#include <cstddef>

namespace frm::test {
extern std::atomic<std::size_t> locks;         ///< of all threads
extern thread_local std::size_t locks_here;  ///< of this thread: a recorder's own may do so
}
