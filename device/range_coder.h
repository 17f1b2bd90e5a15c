// Binary arithmetic coding with adaptive probabilities (Witten, Neal and Cleary, Comm. ACM 30, 1987; carries avoided by
// letting a byte out once both ends of the interval agree on it). Both sides have one interface, so that a model is
// written once: bit() gives back the bit, that was handed in or that was read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace frm::device {

/// The chance of a 1, in 1/65536: 31 to 65504.
using Chance = std::uint16_t;
constexpr Chance even_chance = 1 << 15;

inline void adapt(Chance& chance, bool bit) {
    if (bit)
        chance = static_cast<Chance>(chance + ((65535 - chance) >> 5));
    else
        chance = static_cast<Chance>(chance - (chance >> 5));
}

class RangeInterval {
protected:
    std::uint32_t split(Chance chance) const {
        return low_ + static_cast<std::uint32_t>((std::uint64_t{high_ - low_} * chance) >> 16);
    }
    void take(std::uint32_t middle, bool bit) { (bit ? high_ = middle : low_ = middle + 1); }
    bool agrees() const { return ((low_ ^ high_) & 0xFF000000u) == 0; }
    void shift() { low_ <<= 8, high_ = high_ << 8 | 0xFF; }

    std::uint32_t low_ = 0, high_ = 0xFFFFFFFFu;
};

class RangeEncoder : RangeInterval {
public:
    static constexpr bool encodes = true;

    bool bit(Chance& chance, bool bit) {
        put(chance, bit);
        adapt(chance, bit);
        return bit;
    }
    /// The low `count` bits as they are.
    std::uint64_t plain(std::uint64_t bits, unsigned count) {
        for (unsigned i = count; i-- > 0;) put(even_chance, (bits >> i & 1) != 0);
        return bits;
    }
    /// Ends a piece: what was coded can be read from `out` alone.
    void finish(std::vector<std::uint8_t>& out) {
        for (int k = 0; k < 4; ++k) out_.push_back(static_cast<std::uint8_t>(low_ >> (24 - 8 * k)));
        out.insert(out.end(), out_.begin(), out_.end());
        out_.clear();
        low_ = 0, high_ = 0xFFFFFFFFu;
    }
    std::size_t size() const { return out_.size(); }

private:
    void put(Chance chance, bool bit) {
        take(split(chance), bit);
        while (agrees()) {
            out_.push_back(static_cast<std::uint8_t>(high_ >> 24));
            shift();
        }
    }

    std::vector<std::uint8_t> out_;
};

/// Reads zeros past the end; whole() says whether exactly all of the bytes were used.
class RangeDecoder : RangeInterval {
public:
    static constexpr bool encodes = false;

    void start(const std::uint8_t* data, std::size_t size) {
        data_ = data, size_ = size, at_ = 0, value_ = 0;
        low_ = 0, high_ = 0xFFFFFFFFu;
        for (int k = 0; k < 4; ++k) value_ = value_ << 8 | next();
    }
    bool bit(Chance& chance, bool) {
        const bool bit = get(chance);
        adapt(chance, bit);
        return bit;
    }
    std::uint64_t plain(std::uint64_t, unsigned count) {
        std::uint64_t bits = 0;
        for (unsigned i = 0; i < count; ++i) bits = bits << 1 | (get(even_chance) ? 1u : 0u);
        return bits;
    }
    bool whole() const { return at_ == size_; }
    bool beyond() const { return at_ > size_ + 8; }

private:
    std::uint32_t next() { return at_ < size_ ? data_[at_++] : (++at_, 0u); }
    bool get(Chance chance) {
        const std::uint32_t middle = split(chance);
        const bool bit = value_ <= middle;
        take(middle, bit);
        while (agrees()) {
            shift();
            value_ = value_ << 8 | next();
        }
        return bit;
    }

    const std::uint8_t* data_ = nullptr;
    std::size_t size_ = 0, at_ = 0;
    std::uint32_t value_ = 0;
};

}  // namespace frm::device
