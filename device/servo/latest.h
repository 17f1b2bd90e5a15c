// The newest value of one writer for any number of readers, without locks: neither ever waits for the other. The writer
// goes round a few slots; a reader that was overtaken by a whole round (its slot's number has changed) looks again. All
// words are atomic, so that a torn read is seen and not undefined.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace frm::device {

template <typename T>
class Latest {
    static_assert(std::is_trivially_copyable_v<T>);

public:
    Latest() { write(T{}); }

    /// One thread at a time.
    void write(const T& value) {
        std::array<std::uint64_t, words> raw{};
        std::memcpy(raw.data(), &value, sizeof value);
        const std::uint64_t number = newest_.load(std::memory_order_relaxed) + 1;
        Slot& slot = slots_[number % slots];
        slot.number.store(0, std::memory_order_relaxed);
        // Release: whoever sees one of these words sees the 0 before it.
        for (std::size_t i = 0; i < words; ++i) slot.word[i].store(raw[i], std::memory_order_release);
        slot.number.store(number, std::memory_order_release);
        newest_.store(number, std::memory_order_release);
    }

    T read() const {
        std::array<std::uint64_t, words> raw;
        for (;;) {
            const std::uint64_t number = newest_.load(std::memory_order_acquire);
            const Slot& slot = slots_[number % slots];
            if (slot.number.load(std::memory_order_acquire) != number) continue;
            for (std::size_t i = 0; i < words; ++i) raw[i] = slot.word[i].load(std::memory_order_acquire);
            if (slot.number.load(std::memory_order_relaxed) == number) break;
        }
        T value;
        std::memcpy(static_cast<void*>(&value), raw.data(), sizeof value);
        return value;
    }

private:
    static constexpr std::size_t words = (sizeof(T) + 7) / 8, slots = 4;
    struct Slot {
        std::atomic<std::uint64_t> number{0};
        std::array<std::atomic<std::uint64_t>, words> word{};
    };

    std::array<Slot, slots> slots_;
    std::atomic<std::uint64_t> newest_{0};
};

}  // namespace frm::device
