// How long ticks took: percentiles, and a histogram with logarithmic bins.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

namespace frm::cli {

class TickTimes {
public:
    void reserve(std::size_t ticks) { microseconds_.reserve(ticks); }
    void add(double microseconds) { microseconds_.push_back(static_cast<float>(microseconds)); }
    std::size_t count() const { return microseconds_.size(); }
    /// The time that a share of the ticks stays under.
    double quantile(double share) const;
    double mean() const;
    /// median, p99, p9999, max, mean, and histogram: {edges_us, counts}.
    nlohmann::ordered_json json() const;

private:
    std::vector<float> microseconds_;
};

}  // namespace frm::cli
