// What a SPIDAR-G's driver works out in an exchange, without the bus: for frm bench.
#pragma once

namespace frm::cli {

/// Microseconds, each the median of batches over `seconds` of wall time.
struct SpidarTimes {
    double pose;            ///< from the lengths of a grip at 1 m/s
    double tensions;        ///< of a wrench that changes as the grip moves
    double tensions_worst;  ///< of wrenches that have nothing to do with the one before, many out of reach: 99 %
};

SpidarTimes measure_spidar(double seconds);

}  // namespace frm::cli
