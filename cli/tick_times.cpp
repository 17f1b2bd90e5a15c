#include "cli/tick_times.h"

#include <algorithm>
#include <cmath>

namespace frm::cli {

double TickTimes::quantile(double share) const {
    if (microseconds_.empty()) return 0;
    std::vector<float> sorted = microseconds_;
    const auto at = std::min(sorted.size() - 1, static_cast<std::size_t>(share * static_cast<double>(sorted.size())));
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(at), sorted.end());
    return static_cast<double>(sorted[at]);
}

double TickTimes::mean() const {
    double sum = 0;
    for (const float t : microseconds_) sum += static_cast<double>(t);
    return microseconds_.empty() ? 0 : sum / static_cast<double>(microseconds_.size());
}

nlohmann::ordered_json TickTimes::json() const {
    constexpr double bins_a_decade = 16;
    nlohmann::ordered_json edges = nlohmann::ordered_json::array(), counts = nlohmann::ordered_json::array();
    if (!microseconds_.empty()) {
        const auto [low, high] = std::minmax_element(microseconds_.begin(), microseconds_.end());
        const auto bin = [&](float t) {
            return static_cast<int>(std::floor(bins_a_decade * std::log10(std::max(t, 1e-3f))));
        };
        const int first = bin(*low), last = bin(*high);
        std::vector<std::size_t> in(static_cast<std::size_t>(last - first + 1), 0);
        for (const float t : microseconds_) ++in[static_cast<std::size_t>(std::clamp(bin(t), first, last) - first)];
        for (int b = first; b <= last + 1; ++b) edges.push_back(std::pow(10.0, b / bins_a_decade));
        for (const std::size_t n : in) counts.push_back(n);
    }
    return {
        {"median", quantile(0.5)}, {"p99", quantile(0.99)}, {"p9999", quantile(0.9999)},
        {"max", quantile(1)},      {"mean", mean()},        {"histogram", {{"edges_us", edges}, {"counts", counts}}}};
}

}  // namespace frm::cli
