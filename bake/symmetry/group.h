// Finite groups of rotations and reflections, from generators that are only nearly right.
#pragma once

#include <cstddef>
#include <vector>

#include "bake/math/matrix.h"

namespace frm::bake {

/// Elements closer than this are one: the largest difference of two entries. The rotations of a group of at most 120
/// elements with axes of at most 12 turns are farther apart.
constexpr double kSameElement = 0.12;
constexpr std::size_t kMostElements = 120;  ///< of the icosahedron, with reflections: the largest that is no family

/// Index of the element that is nearly g; elements.size() if there is none.
std::size_t find_element(const std::vector<Matrix3>& elements, const Matrix3& g);

/// The group that the generators span, made exact: closed under multiplication to rounding, each element as near to
/// what the generators say as that allows. Empty if they do not span a group of at most 120 elements.
///
/// Order: rotations before reflections, then by falling trace (the identity first, small turns before large ones), then
/// by entries, row by row, the largest first.
std::vector<Matrix3> span_group(const std::vector<Matrix3>& generators);

}  // namespace frm::bake
