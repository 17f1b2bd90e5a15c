// The SH4 amplifier (USB 0CEC:0205): 512 bytes out, 512 bytes in. Both directions of the format are here, because the
// simulated amplifier speaks the other half.
#pragma once

#include "device/spidar_g/amplifier.h"

namespace frm::spidar_g {

class Sh4 final : public Amplifier {
public:
    static constexpr std::size_t packet_size = 512;

    Request opening() const override { return {}; }
    void request(const Digits& digits, Request& out) const override;
    std::size_t reply_size() const override { return packet_size; }
    void read(const std::uint8_t* reply, Reading& out) const override;
    std::int64_t counter_range() const override { return 65536; }

    /// The device's half. False for a packet that is none of the host's.
    static bool read_request(const std::uint8_t* packet, std::size_t size, Digits& out);
    static void write_reply(const Digits& echo, const Reading& reading, Packet& out);
};

}  // namespace frm::spidar_g
