#include "device/safety/watchdog.h"

#include <algorithm>
#include <chrono>

#include "device/start_thread.h"

namespace frm::device {
namespace {

std::int64_t now_ns() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

constexpr std::int64_t longest_sleep = 10'000'000, shortest_sleep = 200'000;
// A string at 10 m/s wraps a 16-bit counter in 55 ms (docs/devices.md).
constexpr std::int64_t alone_after = 10'000'000, keep_period = 5'000'000;

}  // namespace

void Watchdog::begin() {
    if (thread_.joinable()) return;
    quit_.store(false);
    thread_ = start_thread("the watchdog of the deadline", [this] { watch(); });
}

void Watchdog::end() {
    quit_.store(true);
    if (thread_.joinable()) thread_.join();
}

void Watchdog::feed(std::uint64_t deadline_ns) {
    constexpr std::uint64_t year = 31'536'000'000'000'000;  // sums stay far from the end of the numbers
    const auto deadline = static_cast<std::int64_t>(std::min(deadline_ns, year));
    // The clock is not read for nothing: where the kernel emulates it, that is a system call in a tick.
    const std::int64_t now = keep_ || deadline > 0 ? now_ns() : 0;
    fed_.store(now, std::memory_order_relaxed);
    expires_.store(deadline > 0 ? now + deadline : 0, std::memory_order_release);
}

bool Watchdog::alone() const {
    return expires_.load(std::memory_order_acquire) == 0 &&
           now_ns() - fed_.load(std::memory_order_relaxed) > alone_after;
}

bool Watchdog::overdue() const {
    const std::int64_t expires = expires_.load(std::memory_order_acquire);
    return expires != 0 && expires <= now_ns();
}

void Watchdog::expire() {
    expires_.store(0);
    expired_.store(true);
}

// Sleeps in short pieces instead of waiting for a signal: whoever feeds it takes no lock.
void Watchdog::watch() {
    while (!quit_.load()) {
        const std::int64_t expires = expires_.load(std::memory_order_acquire);
        if (overdue()) stop_(user_);
        if (keep_ && alone()) keep_(user_);
        const std::int64_t left = expires != 0 ? expires - now_ns() : longest_sleep;
        std::this_thread::sleep_for(
            std::chrono::nanoseconds(std::clamp(left, shortest_sleep, keep_ ? keep_period : longest_sleep)));
    }
}

}  // namespace frm::device
