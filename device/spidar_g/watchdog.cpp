#include "device/spidar_g/watchdog.h"

#include <algorithm>
#include <chrono>

#include "device/spidar_g/spidar_g.h"
#include "device/start_thread.h"

namespace frm::spidar_g {
namespace {

// While it rests, and the longest sleep otherwise: an exchange may name a shorter deadline than the one before it did,
// and does not wake this thread.
constexpr std::uint64_t rest_period_ns = 5'000'000;

}  // namespace

void Watchdog::exchanged(std::uint64_t deadline_ns) {
    due_ns_.store(steady_now_ns() + deadline_ns, std::memory_order_relaxed);
    armed_.store(true, std::memory_order_relaxed);
}

Watchdog::Watchdog(SpidarG& device, std::mutex& mutex)
    : device_(device), mutex_(mutex), thread_(device::start_thread("SPIDAR-G", [this] { run(); })) {}

Watchdog::~Watchdog() {
    {
        const std::lock_guard<std::mutex> lock(sleep_);
        ends_ = true;
    }
    wake_.notify_one();
    thread_.join();
}

void Watchdog::run() {
    std::unique_lock<std::mutex> lock(sleep_);
    while (!ends_) {
        std::uint64_t sleep = rest_period_ns;
        const std::uint64_t due = due_ns_.load(std::memory_order_relaxed), at = steady_now_ns();
        if (armed_.load(std::memory_order_relaxed) && at < due) {
            sleep = std::min(due - at, rest_period_ns);
        } else {
            const std::lock_guard<std::mutex> device(mutex_);
            // An exchange may have come while this waited for it.
            const bool armed = armed_.load(std::memory_order_relaxed);
            if (!armed || steady_now_ns() >= due_ns_.load(std::memory_order_relaxed)) device_.rest(armed);
        }
        wake_.wait_for(lock, std::chrono::nanoseconds(sleep), [this] { return ends_; });
    }
}

}  // namespace frm::spidar_g
