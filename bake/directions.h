// The flow of every direction of a bake, several at a time: they are independent, so each core takes one whenever it
// is free.
#pragma once

#include <functional>
#include <vector>

#include "bake/flow/flow.h"

namespace frm::bake {

/// Runs all cases, `threads` at a time (0: as many as there are cores) while `memory_limit` allows it; cores that are
/// left over share a case. `done(index, series)` is called once for each case, from any thread but never from two at
/// once; the order is not fixed. `progress` likewise. Throws what a case threw; the others are then stopped.
void solve_directions(const Surface& surface, const Regions& regions, const std::vector<FlowCase>& cases,
                      const std::vector<FlowPlan>& plans, int threads, std::uint64_t memory_limit,
                      const Progress& progress, const std::function<void(std::size_t, const FlowSeries&)>& done);

}  // namespace frm::bake
