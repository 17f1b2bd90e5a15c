#include "bake/regions/choose.h"

#include <algorithm>
#include <string>
#include <utility>

#include "bake/regions/regions.h"

namespace frm::bake {

ChosenRegions choose_regions(const Surface& surface, const RegionBudget& budget) {
    if (!(budget.error > 0)) throw BakeError("regions: the error must be more than 0");
    if (budget.least < 1 || budget.most < budget.least || budget.most > kMostRegions)
        throw BakeError("regions: at least 1, at most " + std::to_string(kMostRegions) +
                        ", and no fewer than the least");
    const auto triangles =
        static_cast<std::uint32_t>(std::min<std::size_t>(surface.triangles.size(), 4 * kMostRegions));
    const std::uint32_t least = std::min(budget.least, std::max(triangles, 1u));
    const std::uint32_t most = std::max(least, std::min(budget.most, triangles / 4));

    const RegionJudge judge(surface);
    const auto with = [&](std::uint32_t count) {
        ChosenRegions result;
        result.regions = split_regions(surface, count);
        result.errors = judge.measure(result.regions);
        result.reached = result.errors.whole <= budget.error;
        return result;
    };

    // Errors fall about as one over the count, with a few percent of noise: the next count to try is where that says,
    // within bounds. (Splitting the worst region in two again and again was tried: it needs as many regions or a
    // quarter more, save for a tenth fewer on the canoe, and ten times the time, as each step judges all.)
    const auto bounded = [](double count, std::uint32_t low, std::uint32_t high) {
        return static_cast<std::uint32_t>(
            std::min(std::max(count, static_cast<double>(low)), static_cast<double>(high)));
    };
    std::uint32_t below = least;  // does not reach the budget, unless nothing does less
    ChosenRegions best = with(least);
    double error_below = best.errors.whole;
    while (!best.reached && best.regions.count < most) {
        below = best.regions.count;
        error_below = best.errors.whole;
        const std::uint32_t low = std::min(most, below + std::max(1u, below / 4));
        best = with(bounded(below * error_below / budget.error, low, std::max(low, std::min(most, 8 * below))));
    }
    while (best.reached && best.regions.count - below > std::max(1u, below / 16)) {
        const std::uint32_t between = best.regions.count - below, margin = std::max(1u, between / 8);
        const double share = (1 / budget.error - 1 / error_below) / (1 / best.errors.whole - 1 / error_below);
        ChosenRegions tried = with(bounded(below + share * between, below + margin, best.regions.count - margin));
        if (tried.reached) {
            best = std::move(tried);
        } else {
            below = tried.regions.count;
            error_below = tried.errors.whole;
        }
    }
    return best;
}

}  // namespace frm::bake
