#include "bake/directions/fluctuations.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "bake/series/align.h"

namespace frm::bake {
namespace {

constexpr std::size_t components = 6;
constexpr double most_level = 2;

/// The force at each sample, [sample][region][component], of the image of a flow.
std::vector<float> carried(const TaskResult& result, const Transfer& transfer, std::uint32_t regions) {
    std::vector<float> out(std::size_t{result.samples} * regions * components, 0.0f);
    const Matrix3& g = transfer.g();
    const auto add = [&](const std::vector<float>& from, std::size_t i, double share, float* to) {
        const Vec3d f = g * (Vec3d(Vec3f{from[i], from[i + 1], from[i + 2]}) * share);
        for (int c = 0; c < 3; ++c) to[c] += static_cast<float>(f[c]);
    };
    for (std::size_t s = 0; s < result.samples; ++s) {
        for (const Transfer::Share& part : transfer.shares()) {
            const std::size_t i = (s * result.regions + part.patch) * 3;
            float* const to = out.data() + (s * regions + part.region) * components;
            add(result.pressure, i, part.share, to);
            add(result.friction, i, part.share, to + 3);
        }
    }
    return out;
}

std::vector<Vec3d> whole(const Fluctuation& f, std::uint32_t regions, std::uint32_t samples) {
    std::vector<Vec3d> out(samples);
    for (std::size_t l = 0; l < regions; ++l)
        for (std::size_t s = 0; s < samples; ++s)
            for (std::size_t c = 0; c < components; ++c)
                out[s][static_cast<int>(c % 3)] += static_cast<double>(f[(l * samples + s) * components + c]);
    return out;
}

/// Part of a record: a period and what is faded into its beginning.
struct Stretch {
    std::size_t begin = 0, length = 0;
};

/// One period after another, as many as there are; of a record that is hardly longer than one, all of it.
std::vector<Stretch> stretches_of(std::size_t samples, std::size_t period) {
    const std::size_t length = period + static_cast<std::size_t>(overlap_share * static_cast<double>(period));
    if (samples < length + period) return {{0, samples}};
    std::vector<Stretch> out;
    for (std::size_t begin = 0; begin + length <= samples; begin += period) out.push_back({begin, length});
    return out;
}

std::vector<Vec3d> cut(const std::vector<Vec3d>& force, const Stretch& stretch) {
    const auto begin = force.begin() + static_cast<std::ptrdiff_t>(stretch.begin);
    return {begin, begin + static_cast<std::ptrdiff_t>(stretch.length)};
}

Fluctuation one_direction(const TaskResult& result, const Stretch& stretch, const Seam& seam, const Transfer& transfer,
                          std::uint32_t regions, const PeriodicSpec& spec) {
    const std::vector<float> force = carried(result, transfer, regions);
    Fluctuation out(std::size_t{regions} * spec.samples * components);
    std::vector<float> signal(stretch.length);
    for (std::size_t l = 0; l < regions; ++l) {
        for (std::size_t c = 0; c < components; ++c) {
            for (std::size_t s = 0; s < signal.size(); ++s)
                signal[s] = force[((stretch.begin + s) * regions + l) * components + c];
            const PeriodicSeries series = make_periodic(signal, seam, spec);
            for (std::size_t s = 0; s < spec.samples; ++s)
                out[(l * spec.samples + s) * components + c] = series.fluctuation[s];
        }
    }
    return out;
}

/// A tick goes from sample to sample in straight lines, which swing less than what the samples were taken of: of a harmonic
/// of 36 / 4 samples by 4 %, of one of 36 / 12 by 22 %. With a band-limited series' mean square that of its samples and
/// (a a + a b + b b) / 3 that of a line from a to b, this is how much of the strength lines have.
double share_of_lines(const Fluctuation& f, std::uint32_t regions, std::uint32_t samples) {
    double square = 0, lines = 0;
    for (std::size_t l = 0; l < regions; ++l) {
        for (std::size_t s = 0; s < samples; ++s) {
            const float* const a = f.data() + (l * samples + s) * components;
            const float* const b = f.data() + (l * samples + (s + 1) % samples) * components;
            for (std::size_t c = 0; c < components; ++c) {
                const auto x = static_cast<double>(a[c]), y = static_cast<double>(b[c]);
                square += x * x;
                lines += (x * x + x * y + y * y) / 3;
            }
        }
    }
    return lines > 0 ? std::sqrt(lines / square) : 1;
}

/// How strongly the whole force swings, as the map will have it: of the periodic series. A record swings more, by what is
/// slower than the period, of which it has not one cycle: what is left of its start, above all.
double strength_of(const std::vector<Vec3d>& force, const Seam& seam, PeriodicSpec spec) {
    spec.threshold = 0;
    double square = 0;
    for (int c = 0; c < 3; ++c) {
        std::vector<float> signal;
        for (const Vec3d& f : force) signal.push_back(static_cast<float>(f[c]));
        for (const float v : make_periodic(signal, seam, spec).fluctuation)
            square += static_cast<double>(v) * static_cast<double>(v) / spec.samples;
    }
    return std::sqrt(square);
}

/// A flow's strength is that of its whole record, since a period has a few sheddings only; its series is of the stretch that
/// is nearest to it.
struct FlowSwing {
    double strength = 0;
    Stretch stretch;
    Seam seam;  ///< of the stretch
    double of_stretch = 0;
};

FlowSwing swing_of(const TaskResult& result, const PeriodicSpec& spec) {
    const std::vector<Vec3d> force = whole_force(result);
    const std::vector<Stretch> stretches = stretches_of(force.size(), spec.period);
    std::vector<Seam> seams;
    std::vector<double> strength;
    double square = 0;
    for (const Stretch& stretch : stretches) {
        const std::vector<Vec3d> part = cut(force, stretch);
        seams.push_back(make_seam(part, spec.period));
        strength.push_back(strength_of(part, seams.back(), spec));
        square += strength.back() * strength.back() / static_cast<double>(stretches.size());
    }
    FlowSwing out;
    out.strength = std::sqrt(square);
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < strength.size(); ++i)
        if (std::fabs(strength[i] - out.strength) < std::fabs(strength[nearest] - out.strength)) nearest = i;
    out.stretch = stretches[nearest];
    out.seam = seams[nearest];
    out.of_stretch = strength[nearest];
    return out;
}

/// The strengths over directions, by a fit of their logarithms: from one direction to another they change by factors.
class Strengths {
public:
    Strengths(const std::vector<FitSite>& sites, const std::vector<FlowSwing>& swings)
        // Of a record a few sheddings long a strength is known to some tenths: too little to choose a fit by.
        : sites_(sites), fit_(sites, {1, 1e-2}) {
        for (const FlowSwing& swing : swings) strength_.push_back(swing.strength);
        constexpr double least = 1e-6;  // share of the largest
        const double floor = least * *std::max_element(strength_.begin(), strength_.end());
        for (double& s : strength_) s = std::max({s, floor, std::numeric_limits<double>::min()});
    }

    double of(std::size_t flow) const { return strength_[flow]; }
    double at(const Vec3d& e) const {
        const std::vector<double> weights = fit_.weights(e);
        double sum = 0;
        for (std::size_t i = 0; i < weights.size(); ++i) sum += weights[i] * std::log(strength_[sites_[i].group]);
        return std::exp(sum);
    }

private:
    const std::vector<FitSite>& sites_;
    DirectionFit fit_;
    std::vector<double> strength_;  // [flow]
};

/// Pairs of directions that share a face of the set.
std::vector<std::pair<std::uint32_t, std::uint32_t>> neighbours_in(const DirectionSet& set) {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    for (std::uint32_t f = 0; f < set.faces(); ++f) {
        const std::array<std::uint32_t, 3> c = set.corners(f);
        for (const auto& [a, b] : {std::pair{c[0], c[1]}, std::pair{c[1], c[2]}, std::pair{c[2], c[0]}})
            pairs.emplace_back(std::min(a, b), std::max(a, b));
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

}  // namespace

std::vector<Fluctuation> fluctuations(const RegionForces& forces, const std::vector<const TaskResult*>& results,
                                      std::uint32_t regions, const DirectionSet& directions, const PeriodicSpec& spec) {
    std::vector<FlowSwing> swings;
    for (const TaskResult* result : results) swings.push_back(swing_of(*result, spec));
    const Strengths strengths(forces.known().sites(), swings);
    std::vector<Fluctuation> out;
    std::vector<std::vector<Vec3d>> wholes;
    for (std::uint32_t d = 0; d < directions.count(); ++d) {
        const Vec3d e = directions.direction(d);
        const RegionForces::Nearest from = forces.nearest(e);
        const FlowSwing& swing = swings[from.flow];
        Fluctuation f = one_direction(*results[from.flow], swing.stretch, swing.seam, *from.transfer, regions, spec);
        // Between flows the strength is the fit's, not the nearest one's: within bounds, since regions may swing
        // strongly where the whole hardly does.
        double level = from.solved ? 1 : std::min(most_level, strengths.at(e) / strengths.of(from.flow));
        level /= share_of_lines(f, regions, spec.samples);
        if (swing.of_stretch > 0) level *= swing.strength / swing.of_stretch;
        for (float& v : f) v *= static_cast<float>(level);
        wholes.push_back(whole(f, regions, spec.samples));
        out.push_back(std::move(f));
    }
    const std::vector<std::uint32_t> shift = align(wholes, neighbours_in(directions));
    for (std::size_t d = 0; d < out.size(); ++d) {
        for (std::size_t l = 0; l < regions; ++l) {
            const auto row = out[d].begin() + static_cast<std::ptrdiff_t>(l * spec.samples * components);
            std::rotate(row, row + static_cast<std::ptrdiff_t>(shift[d] * components),
                        row + static_cast<std::ptrdiff_t>(spec.samples * components));
        }
    }
    return out;
}

}  // namespace frm::bake
