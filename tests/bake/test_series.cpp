#include <cmath>
#include <cstdint>

#include "bake/series/align.h"
#include "bake/series/periodic.h"
#include "bake/series/spectrum.h"
#include "tests/support/catch.h"

using namespace frm;
using namespace frm::bake;

namespace {

constexpr double pi = 3.14159265358979323846;

std::vector<float> sine(std::size_t samples, double cycles_per_sample, double amplitude, double mean = 0,
                        double slope = 0) {
    std::vector<float> s;
    for (std::size_t i = 0; i < samples; ++i)
        s.push_back(static_cast<float>(mean + slope * static_cast<double>(i) +
                                       amplitude * std::sin(2 * pi * cycles_per_sample * static_cast<double>(i))));
    return s;
}

double rms(const std::vector<float>& s) {
    double sum = 0;
    for (const float v : s) sum += static_cast<double>(v) * static_cast<double>(v);
    return std::sqrt(sum / static_cast<double>(s.size()));
}

/// The signal as the x component of a force.
PeriodicSeries periodic_of(const std::vector<float>& signal, const PeriodicSpec& spec) {
    std::vector<Vec3d> force;
    for (const float v : signal) force.push_back({static_cast<double>(v), 0, 0});
    return make_periodic(signal, make_seam(force, spec.period), spec);
}

/// Band-limited noise: tones of random phase, none of which fits into a period.
std::vector<float> noise(std::size_t samples, std::uint32_t seed) {
    std::vector<float> s(samples, 0.0f);
    for (int k = 0; k < 12; ++k) {
        seed = seed * 1664525u + 1013904223u;
        const double phase = 2 * pi * seed / 4294967296.0, cycles = 5.37 + 1.913 * k;
        for (std::size_t i = 0; i < samples; ++i)
            s[i] += static_cast<float>(std::sin(phase + 2 * pi * cycles * static_cast<double>(i) / 512));
    }
    return s;
}

}  // namespace

TEST_CASE("a signal that is periodic already stays as it is", "[series]") {
    const auto signal = sine(256, 4.0 / 256, 2, 5);
    const PeriodicSeries p = periodic_of(signal, {256, 64, 16, 0});
    CHECK(p.mean == Approx(5));
    for (std::size_t i = 0; i < 64; ++i)
        CHECK(static_cast<double>(p.fluctuation[i]) ==
              Approx(2 * std::sin(2 * pi * 4 * static_cast<double>(i) / 64)).margin(1e-4));
}

TEST_CASE("the seam is as smooth as the rest", "[series]") {
    // Seven and a half cycles with a drift: a bare period would jump by an amplitude and more.
    const auto signal = sine(320, 7.5 / 256, 1, 0, 0.003);
    const PeriodicSeries p = periodic_of(signal, {256, 128, 40, 0});
    double largest = 0;
    for (std::size_t i = 0; i + 1 < 128; ++i)
        largest = std::max(largest, std::fabs(static_cast<double>(p.fluctuation[i + 1] - p.fluctuation[i])));
    const double seam = std::fabs(static_cast<double>(p.fluctuation[0] - p.fluctuation[127]));
    CHECK(seam <= largest);
    CHECK(largest < 1.5 * 2 * pi * 7.5 / 128);
    // The fade costs little of the amplitude.
    CHECK(rms(p.fluctuation) > 0.85 * std::sqrt(0.5));
    CHECK(rms(p.fluctuation) < 1.15 * std::sqrt(0.5) + 0.2);
}

TEST_CASE("harmonics above the highest and below the threshold are gone", "[series]") {
    std::vector<float> signal = sine(256, 4.0 / 256, 1);
    const auto weak = sine(256, 9.0 / 256, 0.01), fast = sine(256, 60.0 / 256, 1);
    for (std::size_t i = 0; i < 256; ++i) signal[i] += weak[i] + fast[i];
    const PeriodicSeries p = periodic_of(signal, {256, 64, 20, 0.02});
    CHECK(rms(p.fluctuation) == Approx(std::sqrt(0.5)).epsilon(1e-4));
    const PeriodicSeries with = periodic_of(signal, {256, 64, 20, 0.005});
    CHECK(rms(with.fluctuation) > rms(p.fluctuation) * 1.00002);
}

TEST_CASE("a run that is too short is refused", "[series]") {
    CHECK_THROWS_AS(periodic_of(sine(100, 0.1, 1), {256, 64, 16, 0}), BakeError);
    CHECK_THROWS_AS(periodic_of(sine(256, 0.1, 1), {256, 64, 32, 0}), BakeError);
}

TEST_CASE("good lengths are even and smooth", "[series]") {
    CHECK(good_length(34) == 36);
    CHECK(good_length(82) == 90);
    CHECK(good_length(64) == 64);
    CHECK(good_length(1) == 2);
}

TEST_CASE("the strongest frequency is found between the bins", "[series]") {
    for (const double cycles : {5.0, 7.3, 11.5, 20.21}) {
        const Peak peak = strongest_peak(sine(512, cycles / 512, 0.3, 4), 0.01);
        CHECK(peak.frequency == Approx(cycles / 5.12).epsilon(1e-4));
        CHECK(peak.amplitude == Approx(0.3).epsilon(0.16));  // a Hann window's scalloping, at most 15 %
    }
    CHECK(strongest_peak(std::vector<float>(512, 3.0f), 0.01).frequency == 0);
}

TEST_CASE("a frequency is good to half a per cent from eight periods", "[series]") {
    // As a wake's lift: a second harmonic, a drift, an amplitude that grows, and noise a tenth of the amplitude. The
    // least that can be known of it (Cramer and Rao) is 0.1 % here.
    std::uint32_t state = 1;
    const auto random = [&] { return static_cast<double>(state = state * 1664525u + 1013904223u) / 4294967296.0; };
    for (const double periods : {8.0, 8.3, 8.5, 12.7, 20.1, 30.6}) {
        for (int trial = 0; trial < 8; ++trial) {
            const double per_sample = 1 / 40.0, first = 2 * pi * random(), second = 2 * pi * random();
            const double drift = random() - 0.5, growth = random();
            const auto samples = static_cast<std::size_t>(periods / per_sample);
            std::vector<float> lift;
            for (std::size_t i = 0; i < samples; ++i) {
                const double t = static_cast<double>(i), share = t / static_cast<double>(samples);
                const double noise = 0.1 * std::sqrt(12.0) * (random() - 0.5);
                lift.push_back(static_cast<float>(
                    (1 - growth + growth * share) *
                        (std::sin(2 * pi * per_sample * t + first) + 0.3 * std::sin(4 * pi * per_sample * t + second)) +
                    drift * share + 5 + noise));
            }
            CHECK(strongest_peak(lift, 0.02).frequency == Approx(per_sample / 0.02).epsilon(0.005));
        }
    }
}

TEST_CASE("a frequency near the highest there is", "[series]") {
    for (const double cycles : {0.24, 0.251, 0.3333, 0.41, 0.47})
        CHECK(strongest_peak(sine(300, cycles, 1), 1).frequency == Approx(cycles).epsilon(1e-3));
}

TEST_CASE("noise is as strong and as smooth in the seam as elsewhere", "[series]") {
    double inside = 0, seam = 0, jump = 0, step = 0;
    for (std::uint32_t seed = 1; seed <= 200; ++seed) {
        const PeriodicSeries p = periodic_of(noise(640, seed), {512, 256, 60, 0});
        for (std::size_t i = 0; i < 256; ++i) {
            const auto v = static_cast<double>(p.fluctuation[i]),
                       next = static_cast<double>(p.fluctuation[(i + 1) % 256]);
            // The overlap of 128 samples of 512 is the first quarter.
            (i < 64 ? seam : inside) += v * v / (i < 64 ? 64 : 192);
            (i == 255 ? jump : step) += (next - v) * (next - v) / (i == 255 ? 1 : 255);
        }
    }
    CHECK(std::sqrt(seam / inside) == Approx(1).margin(0.07));
    CHECK(std::sqrt(jump / step) == Approx(1).margin(0.15));
}

TEST_CASE("neighbours are turned into step", "[series]") {
    constexpr std::size_t samples = 64;
    std::vector<std::vector<Vec3d>> series;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbours;
    for (std::uint32_t d = 0; d < 6; ++d) {
        std::vector<Vec3d> s;
        for (std::size_t i = 0; i < samples; ++i) {
            const double t = 2 * pi * static_cast<double>(i + 11 * d * d) / samples;
            s.push_back({0, std::cos(3 * t) + 0.3 * std::cos(5 * t), 0.1 * std::sin(2 * t)});
        }
        series.push_back(s);
        if (d > 0) neighbours.emplace_back(d - 1, d);
    }
    const std::vector<std::uint32_t> shift = align(series, neighbours);
    for (std::uint32_t d = 1; d < 6; ++d)
        for (std::size_t i = 0; i < samples; ++i)
            CHECK(length(series[d][(i + shift[d]) % samples] - series[0][(i + shift[0]) % samples]) < 1e-9);
    CHECK(align({}, {}).empty());
}
