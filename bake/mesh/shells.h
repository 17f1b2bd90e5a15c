// The closed pieces of a surface: pairing the triangles at each edge, winding, inside and outside.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bake/mesh/adjacency.h"
#include "bake/mesh/surface.h"

namespace frm::bake {

/// Used by repair() in the order of the members. Every edge of the triangles must have an even number of them.
class Shells {
public:
    Shells(const std::vector<Vec3d>& vertices, std::vector<Triangle> triangles);

    /// An edge of four triangles or more that does not fall apart into two of each piece (pieces that touch along an
    /// edge do); null where there is none.
    const HalfEdge* unpaired() const { return has_unpaired_ ? &unpaired_ : nullptr; }

    /// Turns triangles the same way round as the first of their shell. Returns a triangle where that fails, or null.
    const Triangle* make_consistent();
    std::size_t turned() const { return turned_; }

    std::uint32_t count() const { return count_; }
    SurfaceProperties properties(std::uint32_t shell) const;  ///< the volume is negative where the shell faces inward

    /// Returns how many shells were turned round.
    std::uint32_t turn_outward();

    /// Removes shells that lie wholly inside another one; all must face outward. Returns how many.
    std::uint32_t remove_inner();

    /// The shells one after the other, each with its own vertices, in the order of their first triangles.
    Surface surface() const;

private:
    struct Across {
        std::uint32_t triangle = 0, side = 0;
    };

    void pair_edges();
    Surface piece(std::uint32_t shell) const;

    const std::vector<Vec3d>& vertices_;
    std::vector<Triangle> triangles_;
    std::vector<std::array<Across, 3>> across_;
    std::vector<std::uint32_t> shell_;                 // of each triangle
    std::vector<std::vector<std::uint32_t>> members_;  // triangles of each shell, ascending
    std::uint32_t count_ = 0;
    std::size_t turned_ = 0;
    HalfEdge unpaired_;
    bool has_unpaired_ = false;
};

}  // namespace frm::bake
