// What recording costs the thread that ticks, and how much it writes.
#pragma once

#include <cstdint>
#include <vector>

namespace frm::cli {

struct RecordCost {
    double us_per_tick = 0;  ///< of an exchange with a packet, a motion and a tick, beside the same without a recorder
    double kb_per_s = 0;     ///< at 1 kHz
    double lost = 0;         ///< events
};

/// A body in two-way water, moved by a device as a hand would: a sum of slow strokes and a tremor of a tenth of a
/// millimetre, measured by string lengths in steps of 16.7 um, velocities by a filter of 50 Hz; packets of 512 bytes
/// of which those that a SPIDAR-G has change: counters, A/D with a digit of noise, D/A of the force.
RecordCost measure_recording(const std::vector<std::uint8_t>& map_file, double seconds);

}  // namespace frm::cli
