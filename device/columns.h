// How the numbers of a recording's ticks are packed (docs/format.md, "Columns"). Each number of an event has its own
// column, with a model of its own that learns from what went before: which of four predictions is good, how long the
// differences are, and whether the number is one that was there already (a body's pose is its device's, a command is the
// force of the tick before). Encoder and decoder run the same code.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <map>
#include <utility>
#include <vector>

#include "device/range_coder.h"

namespace frm::device {

struct Column {
    std::uint64_t last[3] = {};            ///< newest first
    std::uint16_t cost[4] = {0, 1, 2, 3};  ///< of each prediction, bits, a running sum
    std::uint32_t distance = 0;            ///< at which its numbers were found before; 0: nowhere
    Chance found = even_chance, same = even_chance;
    Chance length[64];  ///< a tree
    Column() {
        for (Chance& chance : length) chance = even_chance;
    }
};

/// The columns of one kind of event about one object.
struct ColumnSet {
    std::vector<Column> columns;
    std::vector<Chance> unchanged;  ///< of groups of bytes
};

template <typename Coder>
class Columns {
public:
    Columns() { restart(); }

    Coder coder;

    /// Forgets all that was learnt.
    void restart() {
        sets_.clear();
        for (auto& row : types_) std::fill(std::begin(row), std::end(row), even_chance);
        previous_type_ = 0;
        words_.assign(history, 0);
        where_.assign(history, 0);
        written_ = 0;
        set_ = nullptr;
        at_ = 0;
    }

    /// Begins an event: its type (below 16), and of which object.
    void begin(std::uint8_t& type, std::uint32_t& object) {
        Chance* const tree = types_[previous_type_];
        std::uint32_t node = 1;
        for (int i = 3; i >= 0; --i) node = node << 1 | (coder.bit(tree[node], (type >> i & 1) != 0) ? 1u : 0u);
        previous_type_ = type = static_cast<std::uint8_t>(node & 15);
        set_ = &sets_[{16, type}], at_ = 0;
        u32(object);
        set_ = &sets_[{type, object}], at_ = 0;
    }
    std::size_t sets() const { return sets_.size(); }

    void u32(std::uint32_t& v) { v = static_cast<std::uint32_t>(word<32>(v)); }
    void u64(std::uint64_t& v) { v = word<64>(v); }
    void f32(float& v) {
        std::uint32_t bits;
        std::memcpy(&bits, &v, 4);
        bits = unordered32(static_cast<std::uint32_t>(word<32>(ordered32(bits))));
        std::memcpy(&v, &bits, 4);
    }
    /// With a prediction from numbers that both sides have.
    void f32(float& v, float prediction) {
        std::uint32_t bits, expected;
        std::memcpy(&bits, &v, 4);
        std::memcpy(&expected, &prediction, 4);
        bits = unordered32(
            static_cast<std::uint32_t>(word<32>(ordered32(bits), std::isfinite(prediction) ? ordered32(expected) : 0)));
        std::memcpy(&v, &bits, 4);
    }
    void f64(double& v) { f64(v, 0); }
    void f64(double& v, double prediction) {
        std::uint64_t bits, expected;
        std::memcpy(&bits, &v, 8);
        std::memcpy(&expected, &prediction, 8);
        bits = unordered64(word<64>(ordered64(bits), ordered64(expected)));
        std::memcpy(&v, &bits, 8);
    }
    /// Passes over what this event leaves out.
    void skip(std::size_t columns) { at_ += columns; }
    /// Numbers without a pattern.
    void random(std::uint32_t& v) { v = static_cast<std::uint32_t>(coder.plain(v, 32)); }
    void random(std::uint64_t& v) {
        const std::uint64_t high = coder.plain(v >> 32, 32), low = coder.plain(v & 0xFFFFFFFFu, 32);
        v = high << 32 | low;
    }
    /// Bytes of a packet, as little-endian words of 16 bits; sixteen bytes that have not changed are one bit.
    void packet(std::uint8_t* data, std::size_t size) {
        for (std::size_t group = 0; group < size; group += 16) {
            const std::size_t index = group / 16, end = std::min(size, group + 16), first = at_;
            if (set_->unchanged.size() <= index) set_->unchanged.resize(index + 1, even_chance);
            reach(first + 8);
            bool same = true;
            if constexpr (Coder::encodes)
                for (std::size_t i = group; i < end; i += 2)
                    same &= word_at(data, i, end) == set_->columns[first + (i - group) / 2].last[0];
            same = coder.bit(set_->unchanged[index], same);
            for (std::size_t i = group; i < end; i += 2) {
                Column& column = set_->columns[first + (i - group) / 2];
                const std::uint64_t value =
                    same ? column.last[0] : number<16>(column, Coder::encodes ? word_at(data, i, end) : 0, 0);
                data[i] = static_cast<std::uint8_t>(value);
                if (i + 1 < end) data[i + 1] = static_cast<std::uint8_t>(value >> 8);
            }
            at_ = first + 8;
        }
    }

private:
    static constexpr std::uint32_t history = 4096;  ///< numbers; a power of two

    static std::uint32_t ordered32(std::uint32_t b) { return b & 0x80000000u ? ~b : b | 0x80000000u; }
    static std::uint32_t unordered32(std::uint32_t b) { return b & 0x80000000u ? b & 0x7FFFFFFFu : ~b; }
    static constexpr std::uint64_t top = std::uint64_t{1} << 63;
    static std::uint64_t ordered64(std::uint64_t b) { return b & top ? ~b : b | top; }
    static std::uint64_t unordered64(std::uint64_t b) { return b & top ? b & ~top : ~b; }
    static std::uint64_t word_at(const std::uint8_t* data, std::size_t i, std::size_t end) {
        return data[i] | (i + 1 < end ? std::uint64_t{data[i + 1]} << 8 : 0);
    }

    void reach(std::size_t count) {
        if (set_->columns.size() < count) set_->columns.resize(count);
    }

    template <unsigned Bits>
    std::uint64_t word(std::uint64_t value, std::uint64_t prediction = 0) {
        reach(at_ + 1);
        Column& column = set_->columns[at_++];
        const auto nth = [&](std::uint32_t distance) { return words_[(written_ - distance) & (history - 1)]; };
        bool found = false;
        if (column.distance > 0) {
            found = coder.bit(column.found, Coder::encodes && nth(column.distance) == value);
            if (found) value = nth(column.distance), learn<Bits>(column, value, prediction);
        }
        if (!found) value = number<Bits>(column, value, prediction);
        // Where has this number been before?
        std::uint32_t& where = where_[value * 0x9E3779B97F4A7C15u >> 52];
        if (!found && written_ > where && written_ - where < history && nth(written_ - where) == value)
            column.distance = written_ - where;
        where = written_;
        words_[written_++ & (history - 1)] = value;
        return value;
    }

    template <unsigned Bits>
    static constexpr std::uint64_t mask = Bits == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << (Bits % 64)) - 1;

    /// Near zero, small: 0, -1, 1, -2, ... become 0, 1, 2, 3, ...
    template <unsigned Bits>
    static std::uint64_t fold(std::uint64_t difference) {
        const std::uint64_t d = difference & mask<Bits>;
        return d >> (Bits - 1) ? (~d << 1 | 1) & mask<Bits> : d << 1;
    }
    template <unsigned Bits>
    static std::uint64_t unfold(std::uint64_t folded) {
        return (folded & 1 ? ~(folded >> 1) : folded >> 1) & mask<Bits>;
    }
    static unsigned length_of(std::uint64_t v) {
        unsigned n = 0;
        for (; v != 0; v >>= 1) ++n;
        return n;
    }
    static std::uint64_t guess(const Column& c, unsigned order, std::uint64_t prediction) {
        switch (order) {
            case 0:
                return c.last[0];
            case 1:
                return 2 * c.last[0] - c.last[1];
            case 2:
                return 3 * (c.last[0] - c.last[1]) + c.last[2];
            default:
                return prediction;
        }
    }

    template <unsigned Bits>
    void learn(Column& c, std::uint64_t value, std::uint64_t prediction) {
        for (unsigned order = 0; order < 4; ++order) {
            const unsigned bits = length_of(fold<Bits>(value - guess(c, order, prediction)));
            c.cost[order] = static_cast<std::uint16_t>(c.cost[order] - (c.cost[order] >> 3) + 8 * bits);
        }
        c.last[2] = c.last[1], c.last[1] = c.last[0], c.last[0] = value;
    }

    template <unsigned Bits>
    std::uint64_t number(Column& c, std::uint64_t value, std::uint64_t prediction) {
        unsigned best = 0;
        for (unsigned order = 1; order < 4; ++order)
            if (c.cost[order] < c.cost[best]) best = order;
        const std::uint64_t expected = guess(c, best, prediction);
        std::uint64_t folded = Coder::encodes ? fold<Bits>(value - expected) : 0;
        if (coder.bit(c.same, folded == 0)) {
            value = expected & mask<Bits>;
        } else {
            // How many bits it has, by a tree; then those below the highest.
            constexpr int levels = Bits == 64 ? 6 : Bits == 32 ? 5 : 4;
            const unsigned length = Coder::encodes ? length_of(folded) - 1 : 0;
            std::uint32_t node = 1;
            for (int i = levels - 1; i >= 0; --i)
                node = node << 1 | (coder.bit(c.length[node], (length >> i & 1) != 0) ? 1u : 0u);
            const unsigned below = node & ((1u << levels) - 1);
            const std::uint64_t highest = std::uint64_t{1} << below;
            folded = highest | coder.plain(folded & (highest - 1), below);
            value = (expected + unfold<Bits>(folded)) & mask<Bits>;
        }
        learn<Bits>(c, value, prediction);
        return value;
    }

    std::map<std::pair<std::uint32_t, std::uint32_t>, ColumnSet> sets_;
    Chance types_[16][16];
    std::uint8_t previous_type_ = 0;
    std::vector<std::uint64_t> words_;
    std::vector<std::uint32_t> where_;
    std::uint32_t written_ = 0;
    ColumnSet* set_ = nullptr;
    std::size_t at_ = 0;
};

}  // namespace frm::device
