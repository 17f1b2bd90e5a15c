// Makes a stretch of a fluctuating signal periodic and smooth (section 5.2 of the paper), so that the run time can go
// round it.
#pragma once

#include <cstdint>
#include <vector>

#include "bake/error.h"
#include "core/math/vec.h"

namespace frm::bake {

/// Of the period: how much of what lies beyond it is faded into its beginning.
constexpr double overlap_share = 0.25;

struct PeriodicSpec {
    std::uint32_t period = 0;     ///< samples of the input that make one period; even
    std::uint32_t samples = 0;    ///< of one period of the output; even
    std::uint32_t harmonics = 0;  ///< the highest kept, at most samples / 2 - 1
    double threshold = 0;  ///< harmonics of a smaller amplitude are dropped (the paper's rule); same unit as the signal
};

struct PeriodicSeries {
    double mean = 0;                 ///< of the whole signal
    std::vector<float> fluctuation;  ///< [samples], mean zero
};

/// How much of the samples beyond the period goes into its beginning, so that the end runs on into the start: a Fourier
/// series of a jump would ring.
struct Seam {
    std::vector<float> first, beyond;  ///< weights, one a sample of the overlap
};

/// The seam of a signal of whole-body forces, the same for all that was recorded with it. The weights go from 0 to 1 and
/// back, divided by what the sum of two stretches that are only partly alike loses: the force swings as much in the seam as
/// elsewhere.
Seam make_seam(const std::vector<Vec3d>& signal, std::uint32_t period);

/// One period made of the input's first `period` samples and, through the seam, those beyond. Then a Fourier series
/// (KissFFT) with the harmonics that the spec keeps, evaluated at the output's samples.
PeriodicSeries make_periodic(const std::vector<float>& signal, const Seam& seam, const PeriodicSpec& spec);

/// The least even number from n on whose prime factors are 2, 3 and 5 only: lengths at which the FFT is fast.
std::uint32_t good_length(std::uint32_t n);

}  // namespace frm::bake
