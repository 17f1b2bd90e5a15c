#include "cli/frontier_error.h"

#include <algorithm>
#include <cmath>

namespace frm::cli {

Peak peak_of(const Readings& readings) {
    Peak peak;
    for (const Reading& r : readings) {
        peak.force = std::max(peak.force, length(r.force));
        peak.torque = std::max(peak.torque, length(r.torque));
    }
    return peak;
}

ForceError error_of(const Readings& readings, const Readings& reference) {
    const Peak peak = peak_of(reference);
    ForceError out;
    const auto add = [](Measure& m, const Vec3d& off) {
        m.rms += dot(off, off);
        m.worst = std::max(m.worst, length(off));
    };
    for (std::size_t i = 0; i < reference.size(); ++i) {
        add(out.force, readings[i].force - reference[i].force);
        add(out.torque, readings[i].torque - reference[i].torque);
    }
    const auto share = [&](Measure& m, double of) {
        m.rms = std::sqrt(m.rms / static_cast<double>(reference.size())) / of;
        m.worst /= of;
    };
    share(out.force, peak.force);
    share(out.torque, peak.torque);
    return out;
}

std::vector<bool> frontier_of(const std::vector<double>& time, const std::vector<double>& error) {
    constexpr double even = 1.03;
    std::vector<bool> out(time.size(), true);
    for (std::size_t i = 0; i < time.size(); ++i)
        for (std::size_t k = 0; k < time.size(); ++k) {
            const bool no_worse = time[k] <= even * time[i] && error[k] <= even * error[i];
            if (no_worse && (even * time[k] < time[i] || even * error[k] < error[i])) out[i] = false;
        }
    return out;
}

double quantile_of(std::vector<double> values, double share) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    const double at = share * static_cast<double>(values.size() - 1);
    const auto low = static_cast<std::size_t>(at);
    const std::size_t high = std::min(low + 1, values.size() - 1);
    return values[low] + (values[high] - values[low]) * (at - static_cast<double>(low));
}

}  // namespace frm::cli
