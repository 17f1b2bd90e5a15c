#include "device/spidar_g/sh4.h"

#include "device/spidar_g/little_endian.h"

namespace frm::spidar_g {
namespace {

// Out: the two bytes of the command, then the DAC values. In: echo, counters, A/D, PIO.
constexpr std::uint8_t command[2] = {0x01, 0x0E};
constexpr std::size_t dac_at = 2, echo_at = 0, counters_at = 16, analogue_at = 32, pio_at = 48;

}  // namespace

void Sh4::request(const Digits& digits, Request& out) const {
    out.count = 1;
    Packet& p = out.packets[0];
    p.bytes.fill(0);
    p.size = packet_size;
    p.bytes[0] = command[0], p.bytes[1] = command[1];
    for (std::size_t i = 0; i < string_count; ++i)
        put16(&p.bytes[dac_at + 2 * i], static_cast<std::uint16_t>(digits[i]));
}

void Sh4::read(const std::uint8_t* reply, Reading& out) const {
    for (std::size_t i = 0; i < string_count; ++i) {
        // Its counters count down where the others count up.
        out.counts[i] = static_cast<std::int16_t>(static_cast<std::uint16_t>(-get16(reply + counters_at + 2 * i)));
        out.analogue[i] = get16(reply + analogue_at + 2 * i);
    }
    out.pio = get16(reply + pio_at);
}

bool Sh4::read_request(const std::uint8_t* packet, std::size_t size, Digits& out) {
    if (size != packet_size || packet[0] != command[0] || packet[1] != command[1]) return false;
    for (std::size_t i = 0; i < string_count; ++i) out[i] = static_cast<std::int16_t>(get16(packet + dac_at + 2 * i));
    return true;
}

void Sh4::write_reply(const Digits& echo, const Reading& reading, Packet& out) {
    out.bytes.fill(0);
    out.size = packet_size;
    for (std::size_t i = 0; i < string_count; ++i) {
        put16(&out.bytes[echo_at + 2 * i], static_cast<std::uint16_t>(echo[i]));
        put16(&out.bytes[counters_at + 2 * i], static_cast<std::uint16_t>(-reading.counts[i]));
        put16(&out.bytes[analogue_at + 2 * i], reading.analogue[i]);
    }
    put16(&out.bytes[pio_at], static_cast<std::uint16_t>(reading.pio));
}

}  // namespace frm::spidar_g
