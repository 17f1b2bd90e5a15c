#include "device/servo/realtime.h"

#include <chrono>
#include <thread>

#if defined(__linux__)
#include <pthread.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <time.h>
#endif

namespace frm::device {

#if defined(__linux__)

bool take_realtime_priority(std::uint32_t priority) {
    sched_param parameters{};
    parameters.sched_priority = static_cast<int>(priority);
    return pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters) == 0;
}

// Not MCL_FUTURE: under a limit of locked memory (RLIMIT_MEMLOCK) it would make later allocations of the host fail.
bool lock_memory() { return mlockall(MCL_CURRENT) == 0; }

void prepare_thread() {
    // 50 us by default, which a real-time thread does not have.
    prctl(PR_SET_TIMERSLACK, 1, 0, 0, 0);
    volatile char stack[64 * 1024];
    for (std::size_t i = 0; i < sizeof stack; i += 1024) stack[i] = 0;
}

std::int64_t clock_now() {
    timespec t{};
    clock_gettime(CLOCK_MONOTONIC, &t);
    return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_nsec;
}

void sleep_until(std::int64_t time) {
    timespec t{};
    t.tv_sec = static_cast<time_t>(time / 1'000'000'000);
    t.tv_nsec = static_cast<long>(time % 1'000'000'000);
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, nullptr) != 0) {
    }
}

#else

bool take_realtime_priority(std::uint32_t) { return false; }
bool lock_memory() { return false; }
void prepare_thread() {}

std::int64_t clock_now() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
}

void sleep_until(std::int64_t time) {
    std::this_thread::sleep_until(std::chrono::steady_clock::time_point(
        std::chrono::duration_cast<std::chrono::steady_clock::duration>(std::chrono::nanoseconds(time))));
}

#endif

}  // namespace frm::device
