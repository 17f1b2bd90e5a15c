// From the threads that tick and exchange to the one that writes: a ring of bytes, made once, in which room is taken
// without a lock, an allocation or a call of the system. Several threads may put, one takes.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

namespace frm::device {

class EventQueue {
public:
    /// `bytes` is rounded up to a power of two. All of it is touched, so that no put meets a page for the first time.
    explicit EventQueue(std::size_t bytes) {
        while (capacity_ < bytes) capacity_ *= 2;
        bytes_ = std::make_unique<std::uint8_t[]>(capacity_);  // zeros
        ends_ = std::make_unique<std::atomic<std::uint64_t>[]>(capacity_ / grain);
        for (std::size_t i = 0; i < capacity_ / grain; ++i) ends_[i].store(0, std::memory_order_relaxed);
    }
    EventQueue(const EventQueue&) = delete;
    EventQueue& operator=(const EventQueue&) = delete;

    std::size_t capacity() const { return capacity_; }
    /// Bytes that are taken, and the most there have been.
    std::uint64_t used() const { return head_.load() - tail_.load(); }
    std::uint64_t most_used() const { return most_.load(); }

    /// Room for `size` bytes, for fill(std::uint8_t*), which gives how many of them it used; false if there is none.
    template <typename Fill>
    bool put(std::uint32_t type, std::size_t size, Fill&& fill) {
        const std::uint64_t length = whole(size);
        if (length > capacity_ / 2) return false;
        std::uint64_t head = head_.load(std::memory_order_relaxed), skipped = 0, end = 0;
        do {
            const std::uint64_t left = capacity_ - (head & (capacity_ - 1));
            skipped = left < length ? left : 0;  // it does not go around the end
            end = head + skipped + length;
            if (end - tail_.load(std::memory_order_acquire) > capacity_) return false;
        } while (!head_.compare_exchange_weak(head, end, std::memory_order_acq_rel, std::memory_order_relaxed));
        if (skipped > 0) publish(head, skip, 0, skipped);
        const std::uint64_t at = head + skipped;
        const std::size_t used = fill(&bytes_[at & (capacity_ - 1)]);
        publish(at, type, used, length);
        const std::uint64_t taken = end - tail_.load(std::memory_order_relaxed);
        std::uint64_t most = most_.load(std::memory_order_relaxed);
        while (taken > most && !most_.compare_exchange_weak(most, taken, std::memory_order_relaxed)) {
        }
        return true;
    }

    /// Takes the oldest: take(type, data, size); false if there is none.
    template <typename Take>
    bool take(Take&& take) {
        for (;;) {
            const std::uint64_t at = tail_.load(std::memory_order_relaxed);
            std::atomic<std::uint64_t>& word = ends_[(at & (capacity_ - 1)) / grain];
            const std::uint64_t end = word.load(std::memory_order_acquire);
            if (end == 0) return false;
            const auto type = static_cast<std::uint32_t>(end >> 56);
            const std::size_t size = end >> 28 & 0xFFFFFFF;
            if (type != skip) take(type, &bytes_[at & (capacity_ - 1)], size);
            word.store(0, std::memory_order_relaxed);
            tail_.store(at + (end & 0xFFFFFFF) * grain, std::memory_order_release);
            if (type != skip) return true;
        }
    }

    static constexpr std::size_t grain = 64, largest = 0xFFFFFFF;

private:
    static constexpr std::uint32_t skip = 255;
    static std::uint64_t whole(std::size_t size) {
        return (size + grain - 1) / grain * grain + (size == 0 ? grain : 0);
    }

    // Type, bytes used and grains taken in one word: what is not 0 can be taken.
    void publish(std::uint64_t at, std::uint32_t type, std::size_t used, std::uint64_t length) {
        ends_[(at & (capacity_ - 1)) / grain].store(
            std::uint64_t{type} << 56 | std::uint64_t{used} << 28 | length / grain, std::memory_order_release);
    }

    std::size_t capacity_ = std::size_t{1} << 16;
    std::unique_ptr<std::uint8_t[]> bytes_;
    std::unique_ptr<std::atomic<std::uint64_t>[]> ends_;
    alignas(64) std::atomic<std::uint64_t> head_{0};
    alignas(64) std::atomic<std::uint64_t> tail_{0};
    alignas(64) std::atomic<std::uint64_t> most_{0};
};

}  // namespace frm::device
