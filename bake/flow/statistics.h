// How well a mean is known from a correlated series.
#pragma once

#include <vector>

namespace frm::bake::flow {

double mean(const std::vector<double>& series);

/// One standard error of the mean, in the units of the series.
double standard_error(const std::vector<double>& series);

}  // namespace frm::bake::flow
