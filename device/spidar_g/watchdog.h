// Lets a device rest when no exchange follows in time.
#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>

namespace frm::spidar_g {

class SpidarG;

/// A thread that looks every 5 ms, and at the deadline. Exchanges hold `mutex`; it is only contended after a deadline
/// has passed. While the device rests its counters are still read every few milliseconds, so that they do not wrap
/// unseen.
class Watchdog {
public:
    Watchdog(SpidarG& device, std::mutex& mutex);
    ~Watchdog();

    /// An exchange begins; the next one is expected within this.
    void exchanged(std::uint64_t deadline_ns);
    /// Nobody is expected for now: the device was stopped or calibrated. Its counters are still followed.
    void disarm() { armed_.store(false, std::memory_order_relaxed); }

private:
    void run();

    SpidarG& device_;
    std::mutex& mutex_;
    std::atomic<std::uint64_t> due_ns_{0};
    std::atomic<bool> armed_{false};
    std::mutex sleep_;
    std::condition_variable wake_;
    bool ends_ = false;
    std::thread thread_;
};

}  // namespace frm::spidar_g
