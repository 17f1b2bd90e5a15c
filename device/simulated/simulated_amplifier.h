// The device's half of both amplifier protocols, on top of a hand on strings: packets in, packets out. The simulated
// device, the usbfs shim and the HID mock of the tests all talk to this one.
#pragma once

#include "device/simulated/hand_on_strings.h"

namespace frm::simulated {

class SimulatedAmplifier {
public:
    explicit SimulatedAmplifier(const Configuration& configuration);

    /// A packet of the host's. What it asks for is answered by a reply of its own.
    void receive(const std::uint8_t* data, std::size_t size);
    bool has_reply() const { return replies_ > 0; }
    /// The oldest reply that is owed, `dt` seconds after the one before it. False if none is.
    bool reply(spidar_g::Packet& out, double dt);
    /// Owed replies are forgotten, as by clearing a pipe.
    void clear() { replies_ = 0; }

    HandOnStrings& hand() { return hand_; }
    const HandOnStrings& hand() const { return hand_; }
    /// What the DAC says now.
    const Tensions& tensions() const { return tensions_; }
    std::uint64_t cycles() const { return cycles_; }

    std::uint32_t rotary = 0, buttons = 0;

private:
    void take(const spidar_g::Digits& digits);

    Configuration configuration_;
    HandOnStrings hand_;
    spidar_g::Digits digits_{};
    Tensions tensions_{};
    spidar_g::Counters offset_{};  ///< where the counters stood when it was switched on
    std::uint64_t cycles_ = 0;
    std::uint32_t replies_ = 0;
};

}  // namespace frm::simulated
