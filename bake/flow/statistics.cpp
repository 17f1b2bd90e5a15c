#include "bake/flow/statistics.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace frm::bake::flow {

double mean(const std::vector<double>& series) {
    double sum = 0;
    for (const double v : series) sum += v;
    return series.empty() ? 0 : sum / static_cast<double>(series.size());
}

// Batch means over 2, 4, ... 32 batches, and the largest of their answers: with long batches the samples of different
// batches are independent but few, with short ones the other way round (Flyvbjerg & Petersen 1989, J. Chem. Phys. 91,
// look for the plateau by eye). A record no longer than the drag's own memory, 3 to 7 lengths, has no plateau; its
// largest answer is the trend between its halves, which is also what is left of the start-up.
double standard_error(const std::vector<double>& series) {
    double largest = 0;
    for (std::size_t batches = 2; batches <= 32 && 2 * batches <= series.size(); batches *= 2) {
        std::vector<double> means(batches, 0.0);
        for (std::size_t b = 0; b < batches; ++b) {
            const std::size_t first = b * series.size() / batches, last = (b + 1) * series.size() / batches;
            for (std::size_t i = first; i < last; ++i) means[b] += series[i];
            means[b] /= static_cast<double>(last - first);
        }
        const double middle = mean(means);
        double square = 0;
        for (const double m : means) square += (m - middle) * (m - middle);
        const double n = static_cast<double>(batches);
        largest = std::max(largest, std::sqrt(square / (n * (n - 1))));
    }
    return largest;
}

}  // namespace frm::bake::flow
