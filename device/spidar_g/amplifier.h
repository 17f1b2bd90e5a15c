// What both amplifiers have in common: eight DAC values out, eight encoder counts and some switches in. Packet formats
// only; who carries the packets is a Transport.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>

#include "device/spidar_g/configuration.h"

namespace frm::spidar_g {

constexpr std::size_t largest_packet = 512;

struct Packet {
    std::array<std::uint8_t, largest_packet> bytes{};
    std::size_t size = 0;
};

using Digits = std::array<std::int16_t, string_count>;
/// As wide as the counters are, sign included, but not extended beyond a wrap.
using Counters = std::array<std::int32_t, string_count>;

/// What a reply says.
struct Reading {
    Counters counts{};
    std::array<std::uint16_t, string_count> analogue{};  ///< A/D digits; 0 where there is none
    std::uint32_t pio = 0;
};

/// One cycle of an amplifier is one or two packets out and one in.
struct Request {
    std::array<Packet, 2> packets;
    std::size_t count = 0;
};

class Amplifier {
public:
    virtual ~Amplifier() = default;

    /// The packets that begin a session, before the first cycle; none for some.
    virtual Request opening() const = 0;
    virtual void request(const Digits& digits, Request& out) const = 0;
    virtual std::size_t reply_size() const = 0;
    /// The reply is whole: reply_size() bytes.
    virtual void read(const std::uint8_t* reply, Reading& out) const = 0;
    /// A counter begins anew after this many.
    virtual std::int64_t counter_range() const = 0;

    /// The rotary switch, 0 to 15, by which devices are told apart.
    static std::uint32_t rotary_id(const Reading& reading) { return reading.pio >> 4 & 0xFu; }
};

std::unique_ptr<Amplifier> make_amplifier(AmplifierKind kind);

/// Extends counters that wrap: the shortest way from the last count, which is right as long as a string moves less than
/// half a range between two readings.
class CounterExtension {
public:
    explicit CounterExtension(std::int64_t range) : range_(range) {}

    /// Counts from zero again at the next reading.
    void reset() { first_ = true; }
    const std::array<std::int64_t, string_count>& add(const Counters& counts);

private:
    std::int64_t range_;
    bool first_ = true;
    Counters last_{};
    std::array<std::int64_t, string_count> total_{};
};

}  // namespace frm::spidar_g
