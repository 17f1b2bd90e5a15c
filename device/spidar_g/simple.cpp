#include "device/spidar_g/simple.h"

#include <initializer_list>

#include "device/spidar_g/little_endian.h"

namespace frm::spidar_g {
namespace {

constexpr std::uint8_t set_tensions = 0x52, latch_encoders = 0x51, maintain = 0xA2, phase = 0x1A, clear = 0x19;
constexpr std::size_t dac_at = 1, pio_at = 24;

void begin(Packet& p, std::initializer_list<std::uint8_t> head) {
    p.bytes.fill(0);
    p.size = Simple::packet_size;
    std::size_t i = 0;
    for (const std::uint8_t b : head) p.bytes[i++] = b;
}

}  // namespace

Request Simple::opening() const {
    Request out;
    out.count = 2;
    begin(out.packets[0], {maintain, phase, 0xFF});
    begin(out.packets[1], {maintain, clear, 0xFF});
    return out;
}

void Simple::request(const Digits& digits, Request& out) const {
    out.count = 2;
    begin(out.packets[0], {set_tensions});
    for (std::size_t i = 0; i < string_count; ++i)
        put16(&out.packets[0].bytes[dac_at + 2 * i], static_cast<std::uint16_t>(digits[i]));
    begin(out.packets[1], {latch_encoders});
}

void Simple::read(const std::uint8_t* reply, Reading& out) const {
    for (std::size_t i = 0; i < string_count; ++i) out.counts[i] = get24(reply + 3 * i);
    out.analogue = {};
    out.pio = reply[pio_at];
}

Simple::Asks Simple::read_request(const std::uint8_t* packet, std::size_t size, Digits& digits, std::uint8_t& mask) {
    if (size < packet_size) return Asks::nothing;
    if (packet[0] == latch_encoders) return Asks::latch;
    if (packet[0] == maintain) {
        mask = packet[2];
        return packet[1] == phase ? Asks::phase_mask : packet[1] == clear ? Asks::clear_counters : Asks::nothing;
    }
    if (packet[0] != set_tensions) return Asks::nothing;
    for (std::size_t i = 0; i < string_count; ++i)
        digits[i] = static_cast<std::int16_t>(get16(packet + dac_at + 2 * i));
    return Asks::tensions;
}

void Simple::write_reply(const Reading& reading, Packet& out) {
    begin(out, {});
    for (std::size_t i = 0; i < string_count; ++i)
        put24(&out.bytes[3 * i], static_cast<std::uint32_t>(reading.counts[i]));
    out.bytes[pio_at] = static_cast<std::uint8_t>(reading.pio);
}

}  // namespace frm::spidar_g
