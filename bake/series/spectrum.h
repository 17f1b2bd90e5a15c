// The strongest frequency of a signal: the shedding frequency, for a Strouhal number.
#pragma once

#include <vector>

#include "bake/error.h"

namespace frm::bake {

struct Peak {
    double frequency = 0;  ///< Hz; 0 where nothing stands out
    double amplitude = 0;  ///< of the sine, unit of the signal
};

/// The largest peak of the spectrum (Hann window, KissFFT), its place refined by a least-squares fit of a sine with its
/// second harmonic on a drifting mean. Peaks below two cycles in the whole signal are not told from drift and are ignored.
Peak strongest_peak(const std::vector<float>& signal, double interval);

}  // namespace frm::bake
