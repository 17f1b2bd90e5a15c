// What of a real-time thread the system allows. Nothing here fails: it says what it could not do.
#pragma once

#include <cstdint>

namespace frm::device {

/// For the calling thread. False if it was not allowed.
bool take_realtime_priority(std::uint32_t priority);
/// Keeps what the process has mapped now in core. False if it was not allowed.
bool lock_memory();
/// Has the calling thread's stack there, and wakes it without the slack that other threads have.
void prepare_thread();

/// The clock of deadlines, ns.
std::int64_t clock_now();
/// [realtime] Sleeps until that time.
void sleep_until(std::int64_t time);

}  // namespace frm::device
