// Every operator new of the program that this is linked into, counted.
#pragma once

#include <atomic>
#include <cstddef>

namespace frm::test {
extern std::atomic<std::size_t> allocations;         ///< of all threads
extern thread_local std::size_t allocations_here;  ///< of this thread: a recorder's own may do so
}
