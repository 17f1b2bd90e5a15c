// A simulated amplifier as a bus sees it: in the machine's time, and with what is to go wrong with it.
#pragma once

#include <algorithm>
#include <chrono>
#include <string>

#include "device/simulated/simulated_amplifier.h"
#include "tests/device/usbfs_shim.h"

namespace frm::test {

struct SimulatedBoard {
    SimulatedBoard(const char* kind, unsigned rotary) : amplifier(configuration(kind)) { amplifier.rotary = rotary; }

    /// The hand lives in the machine's own time, but for pauses that would throw it off.
    bool next_reply(spidar_g::Packet& reply) {
        if (!amplifier.has_reply()) return false;
        const auto now = std::chrono::steady_clock::now();
        const double dt = std::min(std::chrono::duration<double>(now - last).count(), 0.01);
        last = now;
        return amplifier.reply(reply, std::max(dt, 1e-6));
    }

    /// What a board of the HID class answers.
    bool next_report(spidar_g::Packet& reply) {
        if (!next_reply(reply)) return false;
        reply.size = std::max<std::size_t>(reply.size, FRM_SHIM_REPORT);
        if (fault == FRM_SHIM_SHORT) reply.size = 8;
        return true;
    }

    void look(frm_shim_view& view) const {
        view.cycles = amplifier.cycles();
        std::copy_n(amplifier.tensions().begin(), 8, view.tensions);
        const auto& p = amplifier.hand().pose().position;
        view.position[0] = p.x, view.position[1] = p.y, view.position[2] = p.z;
    }

    simulated::SimulatedAmplifier amplifier;
    int fault = FRM_SHIM_GOOD;
    std::chrono::steady_clock::time_point last = std::chrono::steady_clock::now();

private:
    static spidar_g::Configuration configuration(const std::string& kind) {
        auto c = spidar_g::load_configuration(nullptr);
        if (kind == "simple") c.amplifier = spidar_g::AmplifierKind::simple;
        return c;
    }
};

}  // namespace frm::test
