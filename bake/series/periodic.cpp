#include "bake/series/periodic.h"

#include <kiss_fftr.h>

#include <algorithm>
#include <cmath>
#include <memory>

namespace frm::bake {
namespace {

struct FreePlan {
    void operator()(kiss_fftr_state* plan) const { kiss_fftr_free(plan); }
};
using Plan = std::unique_ptr<kiss_fftr_state, FreePlan>;

Plan make_plan(std::uint32_t length, bool inverse) {
    Plan plan(kiss_fftr_alloc(static_cast<int>(length), inverse, nullptr, nullptr));
    if (!plan) throw std::bad_alloc();
    return plan;
}

}  // namespace

std::uint32_t good_length(std::uint32_t n) {
    for (n += n % 2;; n += 2) {
        std::uint32_t rest = n;
        for (const std::uint32_t prime : {2u, 3u, 5u})
            while (rest % prime == 0) rest /= prime;
        if (rest == 1) return n;
    }
}

Seam make_seam(const std::vector<Vec3d>& signal, std::uint32_t period) {
    const std::size_t overlap =
        std::min<std::size_t>(signal.size() - std::min<std::size_t>(signal.size(), period), period);
    Vec3d mean;
    for (const Vec3d& v : signal) mean += v / static_cast<double>(signal.size());
    double first = 0, beyond = 0, both = 0;
    for (std::size_t i = 0; i < overlap; ++i) {
        const Vec3d a = signal[i] - mean, b = signal[period + i] - mean;
        first += dot(a, a);
        beyond += dot(b, b);
        both += dot(a, b);
    }
    // Two stretches that are opposite would leave nothing to divide by.
    constexpr double least_alike = -0.5;
    const double alike = first * beyond > 0 ? std::clamp(both / std::sqrt(first * beyond), least_alike, 1.0) : 1.0;
    Seam seam;
    for (std::size_t i = 0; i < overlap; ++i) {
        const double a = (static_cast<double>(i) + 0.5) / static_cast<double>(overlap), b = 1 - a;
        const double level = 1 / std::sqrt(a * a + b * b + 2 * a * b * alike);
        seam.first.push_back(static_cast<float>(a * level));
        seam.beyond.push_back(static_cast<float>(b * level));
    }
    return seam;
}

PeriodicSeries make_periodic(const std::vector<float>& signal, const Seam& seam, const PeriodicSpec& spec) {
    const std::uint32_t n = spec.period, m = spec.samples;
    if (n < 2 || n % 2 || m < 2 || m % 2) throw BakeError("series: a period needs an even number of samples");
    if (signal.size() < n + seam.first.size()) throw BakeError("series: the run is shorter than the period");
    if (spec.harmonics >= m / 2) throw BakeError("series: too many harmonics for the number of samples");

    PeriodicSeries out;
    for (const float v : signal) out.mean += static_cast<double>(v) / static_cast<double>(signal.size());
    std::vector<float> period(n);
    const auto mean = static_cast<float>(out.mean);
    for (std::size_t i = 0; i < n; ++i) {
        period[i] = signal[i] - mean;
        if (i < seam.first.size()) period[i] = seam.first[i] * period[i] + seam.beyond[i] * (signal[n + i] - mean);
    }

    std::vector<kiss_fft_cpx> spectrum(n / 2 + 1), kept(m / 2 + 1, kiss_fft_cpx{0, 0});
    kiss_fftr(make_plan(n, false).get(), period.data(), spectrum.data());
    const std::uint32_t highest = std::min(spec.harmonics, n / 2 - 1);
    for (std::uint32_t k = 1; k <= highest; ++k) {
        const double amplitude =
            2 * std::hypot(static_cast<double>(spectrum[k].r), static_cast<double>(spectrum[k].i)) / n;
        if (amplitude < spec.threshold) continue;
        kept[k] = {spectrum[k].r / static_cast<float>(n), spectrum[k].i / static_cast<float>(n)};
    }
    out.fluctuation.resize(m);
    kiss_fftri(make_plan(m, true).get(), kept.data(), out.fluctuation.data());
    return out;
}

}  // namespace frm::bake
