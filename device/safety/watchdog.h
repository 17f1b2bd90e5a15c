// Stops an engaged device whose host has stalled, and keeps one going that nobody talks to, where its driver needs that (its
// counters would wrap unseen). A thread of its own, because the host's is the one that does not come; the only rule that
// looks at this machine's clock (where the device's clock runs on, the safety layer finds the same gap in it, in a replay
// too).
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

namespace frm::device {

class Watchdog {
public:
    /// Called on the watchdog's thread when the deadline has passed: to stop the device and call expire(), unless it
    /// is not overdue() any more or a call of the driver hangs.
    using Stop = void (*)(void* user);
    /// Called on the same thread every few milliseconds while nobody is expected and nobody came for a while. May be null.
    using Keep = void (*)(void* user);

    Watchdog(Stop stop, Keep keep, void* user) : stop_(stop), keep_(keep), user_(user) {}
    ~Watchdog() { end(); }
    Watchdog(const Watchdog&) = delete;
    Watchdog& operator=(const Watchdog&) = delete;

    /// Starts the thread, if it does not run. Throws Error as start_thread().
    void begin();
    void end();
    /// [realtime] Somebody came. Counts from now on; 0: nobody is expected.
    void feed(std::uint64_t deadline_ns);
    bool overdue() const;
    void expire();
    /// [realtime] Whether it has stopped the device since this was asked last.
    bool take_expired() { return expired_.load(std::memory_order_relaxed) && expired_.exchange(false); }

private:
    void watch();
    bool alone() const;

    Stop stop_;
    Keep keep_;
    void* user_;
    std::thread thread_;
    std::atomic<bool> quit_{false}, expired_{false};
    std::atomic<std::int64_t> expires_{0};  ///< steady clock, ns; 0: never
    std::atomic<std::int64_t> fed_{0};      ///< when somebody came last
};

}  // namespace frm::device
