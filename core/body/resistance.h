// Shared by the ways to look up a body's resistance: every source by itself, or groups of them.
#pragma once

#include "core/body/body.h"

namespace frm {

/// The part of sums that begins at lane `first` (0 pressure, 4 friction), turned to the world.
Wrench wrench_of(const Body& body, const LookupSum& sum, int first);

/// Whether so many lookups cost more than the body's share of the time budget.
bool is_dear(const Body& body, std::size_t lookups);

/// Which level of detail keeps the body's budgets; null: every source by itself. Fills body.detail.
const Level* choose_level(Body& body, const LookupMotion& motion);

/// Forces by the groups of a level, whose water is at rest. The map times of the sources are owed until they are next
/// looked up by themselves.
void look_up_groups(Body& body, const Level& level, const LookupMotion& motion);

}  // namespace frm
