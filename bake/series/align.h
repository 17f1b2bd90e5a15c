// Shifts periodic series in time so that neighbours swing together: a blend of series that are out of step swings less
// than any of them.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/math/vec.h"

namespace frm::bake {

/// `series[d][s]`: a force of mean zero at the samples of one period, as many for every d. `neighbours`: pairs of them.
/// Gives for each series by how many samples it is to be turned: its new sample s is its old sample (s + shift) modulo
/// their number. The sum of the correlations between neighbours is then as large as turning one series at a time can make it.
std::vector<std::uint32_t> align(const std::vector<std::vector<Vec3d>>& series,
                                 const std::vector<std::pair<std::uint32_t, std::uint32_t>>& neighbours);

}  // namespace frm::bake
