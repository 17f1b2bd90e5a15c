// The Simple amplifier (USB 0CEC:0203): 32-byte packets, two out (DAC values, latch the encoders) and one in.
#pragma once

#include "device/spidar_g/amplifier.h"

namespace frm::spidar_g {

class Simple final : public Amplifier {
public:
    static constexpr std::size_t packet_size = 32;

    Request opening() const override;
    void request(const Digits& digits, Request& out) const override;
    std::size_t reply_size() const override { return packet_size; }
    void read(const std::uint8_t* reply, Reading& out) const override;
    std::int64_t counter_range() const override { return std::int64_t{1} << 24; }

    /// The device's half: what a packet asks for.
    enum class Asks { nothing, tensions, latch, phase_mask, clear_counters };
    /// `digits` is written for tensions, `mask` for the last two.
    static Asks read_request(const std::uint8_t* packet, std::size_t size, Digits& digits, std::uint8_t& mask);
    static void write_reply(const Reading& reading, Packet& out);
};

}  // namespace frm::spidar_g
