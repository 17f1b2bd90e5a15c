#include "device/simulated/simulated_amplifier.h"

#include <cmath>

#include "device/spidar_g/sh4.h"
#include "device/spidar_g/simple.h"

namespace frm::simulated {

using namespace spidar_g;

SimulatedAmplifier::SimulatedAmplifier(const Configuration& configuration)
    : configuration_(configuration), hand_(configuration) {
    // A device that was switched on long ago: some counters are about to wrap.
    for (std::size_t i = 0; i < string_count; ++i) offset_[i] = static_cast<std::int32_t>(32700 - 9000 * i);
}

void SimulatedAmplifier::take(const Digits& digits) {
    digits_ = digits;
    for (std::size_t i = 0; i < string_count; ++i) {
        const double n = digits[i] / (configuration_.motors[i].volts_per_newton * configuration_.digits_per_volt);
        tensions_[i] = std::fmax(0.0, n);
    }
}

void SimulatedAmplifier::receive(const std::uint8_t* data, std::size_t size) {
    Digits digits{};
    if (configuration_.amplifier == AmplifierKind::sh4) {
        if (!Sh4::read_request(data, size, digits)) return;
        take(digits);
        ++replies_;
        return;
    }
    std::uint8_t mask = 0;
    switch (Simple::read_request(data, size, digits, mask)) {
        case Simple::Asks::tensions:
            take(digits);
            break;
        case Simple::Asks::latch:
            ++replies_;
            break;
        case Simple::Asks::clear_counters: {
            const Counters now = hand_.counts();
            for (std::size_t i = 0; i < string_count; ++i)
                if (mask >> i & 1) offset_[i] = -now[i];
            break;
        }
        default:
            break;
    }
}

bool SimulatedAmplifier::reply(Packet& out, double dt) {
    if (replies_ == 0) return false;
    --replies_;
    ++cycles_;
    hand_.advance(dt, tensions_);
    Reading reading;
    const Counters counts = hand_.counts();
    for (std::size_t i = 0; i < string_count; ++i) {
        reading.counts[i] = counts[i] + offset_[i];
        // What a current sensor would see, in volts of 24 V / 4096.
        reading.analogue[i] =
            static_cast<std::uint16_t>(tensions_[i] * configuration_.motors[i].volts_per_newton * 4096 / 24);
    }
    reading.pio = (rotary & 0xF) << 4 | (buttons & 0xF);
    if (configuration_.amplifier == AmplifierKind::sh4)
        Sh4::write_reply(digits_, reading, out);
    else
        Simple::write_reply(reading, out);
    return true;
}

}  // namespace frm::simulated
