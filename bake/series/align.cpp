#include "bake/series/align.h"

#include <algorithm>
#include <cmath>

namespace frm::bake {
namespace {

constexpr int most_sweeps = 20;

double energy(const std::vector<Vec3d>& series) {
    double sum = 0;
    for (const Vec3d& v : series) sum += dot(v, v);
    return sum;
}

}  // namespace

std::vector<std::uint32_t> align(const std::vector<std::vector<Vec3d>>& series,
                                 const std::vector<std::pair<std::uint32_t, std::uint32_t>>& neighbours) {
    const std::size_t count = series.size(), samples = series.empty() ? 0 : series[0].size();
    // gain[edge][lag]: correlation where the pair's first is turned by lag more than its second.
    std::vector<std::vector<double>> gain;
    std::vector<std::vector<std::size_t>> edges(count);
    for (const auto& [a, b] : neighbours) {
        edges[a].push_back(gain.size());
        edges[b].push_back(gain.size());
        const double unit = std::sqrt(energy(series[a]) * energy(series[b]));
        std::vector<double> row(samples, 0.0);
        for (std::size_t lag = 0; unit > 0 && lag < samples; ++lag) {
            for (std::size_t s = 0; s < samples; ++s) row[lag] += dot(series[a][(s + lag) % samples], series[b][s]);
            row[lag] /= unit;
        }
        gain.push_back(std::move(row));
    }

    std::vector<std::uint32_t> shift(count, 0);
    std::vector<bool> placed(count, false);
    // The shift that fits the placed neighbours best; it must be better than the present one by more than rounding.
    const auto turn = [&](std::size_t d) {
        std::vector<double> sum(samples, 0.0);
        for (const std::size_t e : edges[d]) {
            const auto [a, b] = neighbours[e];
            const std::size_t other = a == d ? b : a;
            if (!placed[other] || other == d) continue;
            for (std::size_t s = 0; s < samples; ++s)
                sum[s] += gain[e][(a == d ? s + samples - shift[other] : shift[other] + samples - s) % samples];
        }
        std::size_t best = shift[d];
        for (std::size_t s = 0; s < samples; ++s)
            if (sum[s] > sum[best] + 1e-9) best = s;
        const bool changed = best != shift[d];
        shift[d] = static_cast<std::uint32_t>(best);
        placed[d] = true;
        return changed;
    };

    // Outwards from the first: each is placed when a neighbour is.
    std::vector<std::size_t> queue;
    for (std::size_t root = 0; root < count; ++root) {
        if (placed[root]) continue;
        turn(root);
        queue.assign(1, root);
        for (std::size_t at = 0; at < queue.size(); ++at) {
            for (const std::size_t e : edges[queue[at]]) {
                const auto [a, b] = neighbours[e];
                const std::size_t next = a == queue[at] ? b : a;
                if (placed[next]) continue;
                turn(next);
                queue.push_back(next);
            }
        }
    }
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
        bool changed = false;
        for (std::size_t d = 0; d < count; ++d) changed = turn(d) || changed;
        if (!changed) break;
    }
    return shift;
}

}  // namespace frm::bake
