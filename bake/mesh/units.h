// Whether a mesh is as large as its file says. glTF counts in metres; much of what is exported was drawn in millimetres,
// centimetres or inches, and a bake of a paddle of 1,500 m would give a map without a complaint.
#pragma once

#include <vector>

namespace frm::bake {

struct Unit {
    const char* name;  ///< "millimetres"
    double scale;      ///< metres in one
};

/// Sizes (longest side, m) that need no question: from a fishing float to a yacht.
constexpr double largest_plausible = 20, smallest_plausible = 0.005;

inline bool plausible_size(double extent) { return extent >= smallest_plausible && extent <= largest_plausible; }

/// The units that an object of this size in the file's numbers may have been drawn in, the likeliest first: that which
/// brings it closest to 1 m, then those that bring it to a plausible size. For what is too small the file was converted
/// once too often: scale is then above 1.
std::vector<Unit> likely_units(double extent);

}  // namespace frm::bake
