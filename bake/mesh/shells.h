// The closed pieces of a surface: pairing the triangles at each edge, winding, inside and outside.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bake/mesh/adjacency.h"
#include "bake/mesh/surface.h"

namespace frm::bake {

/// How often closed, outward pieces wind around a point: 1 inside, 0 outside, 2 where two of them overlap.
double winding(const Surface& surface, const Vec3d& point);

/// Those of `triangles` (of `vertices`) that reach out of closed, outward pieces: their middle or, a fiftieth of the way
/// to the middle, a corner, which itself may lie on the surface. Of very many triangles only some are looked at, evenly
/// chosen: as many as a few seconds allow, 16 at least.
std::vector<Triangle> reaching_outside(const Surface& surface, const std::vector<Vec3d>& vertices,
                                       const std::vector<Triangle>& triangles);

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
    Surface piece(std::uint32_t shell) const;                 ///< with vertices of its own
    SurfaceProperties properties(std::uint32_t shell) const;  ///< the volume is negative where the shell faces inward

    /// Returns how many shells were turned round.
    std::uint32_t turn_outward();

    /// Removes shells that lie wholly inside another one; all must face outward. Returns how many. Among hundreds of
    /// thousands of tangled shells some inner ones may be left: the search ends after some 20 seconds.
    std::uint32_t remove_inner();

    /// The shells one after the other, each with its own vertices, in the order of their first triangles.
    Surface surface() const;

private:
    struct Across {
        std::uint32_t triangle = 0, side = 0;
    };

    void pair_edges();

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
