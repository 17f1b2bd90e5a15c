#include "bake/series/spectrum.h"

#include <kiss_fftr.h>

#include <cmath>
#include <memory>

namespace frm::bake {

Peak strongest_peak(const std::vector<float>& signal, double interval) {
    constexpr double pi = 3.14159265358979323846;
    const std::size_t n = signal.size() / 2 * 2;
    if (n < 16) return {};
    double mean = 0;
    for (std::size_t i = 0; i < n; ++i) mean += static_cast<double>(signal[i]) / static_cast<double>(n);
    std::vector<float> windowed(n);
    for (std::size_t i = 0; i < n; ++i) {
        const double window = 1 - std::cos(2 * pi * static_cast<double>(i) / static_cast<double>(n));  // of mean 1
        windowed[i] = static_cast<float>(window * (static_cast<double>(signal[i]) - mean));
    }
    const std::unique_ptr<kiss_fftr_state, void (*)(kiss_fftr_state*)> plan(
        kiss_fftr_alloc(static_cast<int>(n), 0, nullptr, nullptr), [](kiss_fftr_state* p) { kiss_fftr_free(p); });
    if (!plan) throw std::bad_alloc();
    std::vector<kiss_fft_cpx> spectrum(n / 2 + 1);
    kiss_fftr(plan.get(), windowed.data(), spectrum.data());

    const auto amplitude = [&](std::size_t k) {
        return 2 * std::hypot(static_cast<double>(spectrum[k].r), static_cast<double>(spectrum[k].i)) /
               static_cast<double>(n);
    };
    std::size_t best = 2;
    for (std::size_t k = 3; k + 1 < spectrum.size(); ++k)
        if (amplitude(k) > amplitude(best)) best = k;
    const double a = amplitude(best - 1), b = amplitude(best), c = amplitude(best + 1);
    if (!(b > 0) || a > b) return {};
    double offset = 0;
    if (a > 0 && c > 0) {
        const double left = std::log(a), middle = std::log(b), right = std::log(c);
        const double curve = left - 2 * middle + right;
        if (curve < 0) offset = 0.5 * (left - right) / curve;
    }
    return {(static_cast<double>(best) + offset) / (static_cast<double>(n) * interval), b};
}

}  // namespace frm::bake
