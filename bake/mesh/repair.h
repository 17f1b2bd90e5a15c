// From a triangle soup to a surface fit for baking, or a clear refusal.
#pragma once

#include <string>
#include <vector>

#include "bake/mesh/cuts.h"
#include "bake/mesh/mesh_error.h"
#include "bake/mesh/surface.h"

namespace frm::bake {

struct Repaired {
    Surface surface;                 ///< every edge has exactly two triangles; each shell has vertices of its own
    std::vector<std::string> notes;  ///< what was changed, one sentence each, for the user; empty when nothing was
    std::uint32_t shells = 0;        ///< separate closed pieces
    Cuts cuts;                       ///< where the surface cuts through itself; not mended, only said
};

/// Makes `soup` closed and oriented. In this order:
/// - vertices within a millionth of the size are joined, up to a ten-thousandth where that closes the surface;
/// - triangles without area, copies of a triangle, and walls between two pieces that share a face are removed;
/// - where the surface is still open, tiny holes are closed (holes.h has the limits);
/// - where edges have more than two triangles, walls inside are removed;
/// - each shell is made consistent and turned outward;
/// - a shell wholly inside another is removed, whichever way it faces, as no water reaches it: a sealed cavity is
///   filled (it displaces water as if it were solid).
/// Shells that overlap are kept as they are: a paddle of a blade, a shaft and a grip that run into each other is fine,
/// and so is a surface that cuts through itself. Volume and buoyancy count the overlap twice, so a note says where.
///
/// Throws MeshError, starting with `name` (the file), for a surface that is open, is flat, has edges of more than two
/// triangles that do not fall apart into shells, or has only one side (a Moebius strip or Klein bottle). Throws
/// BakeError where there is no place to show: no triangles, or all vertices in one point.
Repaired repair(const Surface& soup, const std::string& name);

}  // namespace frm::bake
