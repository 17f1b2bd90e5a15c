// 64-bit FNV-1a (Fowler, Noll, Vo), the hash of files (over bytes; docs/format.md) and of a world's state (over 32-bit
// words, in four lanes because one lane is bound by the latency of its multiplication).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <string>

namespace frm {

constexpr std::uint64_t fnv_offset = 14695981039346656037ull;
constexpr std::uint64_t fnv_prime = 1099511628211ull;

inline std::uint64_t fnv1a(const void* data, std::size_t size, std::uint64_t hash = fnv_offset) {
    const auto* bytes = static_cast<const unsigned char*>(data);
    for (std::size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * fnv_prime;
    return hash;
}

/// 16 hexadecimal digits.
inline std::string hash_text(std::uint64_t hash) {
    char text[20];
    std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
    return text;
}

/// Hashes values by their bits, so that -0 and 0 differ: what differs in bits may differ later in force.
class StateHash {
public:
    void words(const void* data, std::size_t count) {
        const auto* bytes = static_cast<const unsigned char*>(data);
        std::size_t i = 0;
        for (; i + 4 <= count; i += 4, bytes += 16) {
            std::uint32_t word[4];
            std::memcpy(word, bytes, sizeof word);
            for (int k = 0; k < 4; ++k) lane_[k] = (lane_[k] ^ word[k]) * fnv_prime;
        }
        for (; i < count; ++i, bytes += 4) {
            std::uint32_t word;
            std::memcpy(&word, bytes, sizeof word);
            lane_[0] = (lane_[0] ^ word) * fnv_prime;
        }
    }
    /// Numbers any of which may be none. Processors differ in the bits of what comes of infinity - infinity, so all that are
    /// none count as one.
    void numbers(const float* values, std::size_t count) {
        for (std::size_t i = 0; i < count; i += 64) {
            float block[64];
            const std::size_t size = count - i < 64 ? count - i : 64;
            for (std::size_t k = 0; k < size; ++k) {
                const float x = values[i + k];
                block[k] = x == x ? x : std::numeric_limits<float>::quiet_NaN();
            }
            words(block, size);
        }
    }
    /// For structs and numbers without padding whose size is a multiple of four.
    template <typename T>
    void value(const T& v) {
        static_assert(sizeof(T) % 4 == 0, "hashed by words of four bytes");
        words(&v, sizeof(T) / 4);
    }
    std::uint64_t result() const { return fnv1a(lane_, sizeof lane_); }

private:
    std::uint64_t lane_[4] = {fnv_offset, fnv_offset + 1, fnv_offset + 2, fnv_offset + 3};
};

}  // namespace frm
