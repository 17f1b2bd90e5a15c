// Who carries packets to an amplifier and back: USB, HID, or a simulated amplifier in the same process.
#pragma once

#include <cstdint>

#include "device/spidar_g/amplifier.h"

namespace frm::spidar_g {

enum class Carried {
    whole,
    cut_off,    ///< the reply was shorter than asked for
    too_late,   ///< no reply within the time
    refused,    ///< the bus or the device refused a packet
    unplugged,  ///< and will not come back
};

class Transport {
public:
    virtual ~Transport() = default;

    /// Puts both directions in order after a failure and at the beginning: halts are cleared, old replies thrown away.
    virtual void recover() = 0;
    /// Packets out, nothing back.
    virtual Carried send(const Request& request) = 0;
    /// Packets out and `size` bytes back, within the configuration's timeout. reply.size is what came.
    virtual Carried cycle(const Request& request, std::size_t size, Packet& reply) = 0;
    /// The clock by which replies come.
    virtual std::uint64_t now_ns() = 0;
    /// Whether its clock runs by itself: then somebody has to watch that exchanges go on.
    virtual bool runs_by_itself() const = 0;
};

/// The monotonic clock of the machine.
std::uint64_t steady_now_ns();

}  // namespace frm::spidar_g
