// Every lock that the program takes which this is linked into, counted.
#pragma once

#include <atomic>
#include <cstddef>

namespace frm::test {
extern std::atomic<std::size_t> locks;  ///< of all threads
/// Of this thread: a recorder's own may do so. (A function, because gcc's sanitizer takes a thread's variable of another file
/// for a null reference.)
std::size_t locks_here();
}  // namespace frm::test
