// Whether a mesh is as large as its file says. glTF counts in metres; much of what is exported was drawn in millimetres,
// centimetres or inches, and a bake of a paddle of 1,500 m would give a map without a complaint.
#pragma once

namespace frm::bake {

struct Unit {
    const char* name;  ///< "millimetres"
    double scale;      ///< metres in one
};

/// Sizes (longest side, m) that need no question: from a fishing float to a yacht.
constexpr double largest_plausible = 20, smallest_plausible = 0.005;

inline bool plausible_size(double extent) { return extent >= smallest_plausible && extent <= largest_plausible; }

/// The unit that an object of this size in the file's numbers was most likely drawn in: the one that brings it closest
/// to 1 m. For what is too small the file was converted once too often: scale is then above 1.
Unit likely_unit(double extent);

}  // namespace frm::bake
