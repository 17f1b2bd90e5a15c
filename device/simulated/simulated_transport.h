// A simulated amplifier in the same process. Its clock is that of its exchanges: a period each.
#pragma once

#include "device/simulated/simulated_amplifier.h"
#include "device/spidar_g/transport.h"

namespace frm::simulated {

class SimulatedTransport final : public spidar_g::Transport {
public:
    explicit SimulatedTransport(const Configuration& configuration)
        : amplifier_(configuration), period_ns_(configuration.period_ns) {}

    void recover() override { amplifier_.clear(); }
    spidar_g::Carried send(const spidar_g::Request& request) override;
    spidar_g::Carried cycle(const spidar_g::Request& request, std::size_t size, spidar_g::Packet& reply) override;
    std::uint64_t now_ns() override { return now_ns_; }
    bool runs_by_itself() const override { return false; }

    SimulatedAmplifier& amplifier() { return amplifier_; }
    /// Lets time pass in which nobody asks: cycles that are lost.
    void lose(std::uint64_t cycles) { now_ns_ += cycles * period_ns_; }

    /// What the next cycles come to; whole: as they should.
    spidar_g::Carried failing = spidar_g::Carried::whole;

private:
    SimulatedAmplifier amplifier_;
    std::uint64_t period_ns_, now_ns_ = 0;
};

}  // namespace frm::simulated
