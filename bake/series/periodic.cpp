#include "bake/series/periodic.h"

#include <kiss_fftr.h>

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

PeriodicSeries make_periodic(const std::vector<float>& signal, const PeriodicSpec& spec) {
    const std::uint32_t n = spec.period, m = spec.samples;
    if (n < 2 || n % 2 || m < 2 || m % 2) throw BakeError("series: a period needs an even number of samples");
    if (signal.size() < n) throw BakeError("series: the run is shorter than the period");
    if (spec.harmonics >= m / 2) throw BakeError("series: too many harmonics for the number of samples");
    const std::size_t overlap = std::min<std::size_t>(signal.size() - n, n);

    std::vector<float> period(signal.begin(), signal.begin() + n);
    for (std::size_t i = 0; i < overlap; ++i) {
        const float rise = (static_cast<float>(i) + 0.5f) / static_cast<float>(overlap);
        period[i] = rise * signal[i] + (1 - rise) * signal[n + i];
    }

    std::vector<kiss_fft_cpx> spectrum(n / 2 + 1), kept(m / 2 + 1, kiss_fft_cpx{0, 0});
    kiss_fftr(make_plan(n, false).get(), period.data(), spectrum.data());
    PeriodicSeries out;
    for (const float v : signal) out.mean += static_cast<double>(v) / static_cast<double>(signal.size());
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
