// From a case in metres to a box of cells: the frame of the stream, how far the box reaches, and the units of the
// lattice.
#pragma once

#include <vector>

#include "bake/flow/flow.h"
#include "bake/flow/lattice.h"
#include "core/math/vec.h"

namespace frm::bake::flow {

/// Right-handed axes of the stream's frame as unit vectors of the mesh's frame: x along the stream.
struct Frame {
    Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

    Vec3d to_stream(const Vec3d& v) const { return {dot(x, v), dot(y, v), dot(z, v)}; }
    Vec3d to_mesh(const Vec3d& v) const { return x * v.x + y * v.y + z * v.z; }
};

/// What of the body meets the water, in cells: a node (i, j, k) sits at (i, j, k). For a section these are the walls of
/// a prism one cell high over the outline, open at the ends.
struct Walls {
    std::vector<Vec3d> vertices;
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> source;  ///< the surface's triangle behind each of `triangles`
};

struct Domain {
    FlowPlan plan;
    Frame frame;
    Grid grid;
    Vec3d origin;              ///< of node (0, 0, 0) in the stream's frame, m
    double stream_speed = 0;   ///< cells a step
    double viscosity = 0;      ///< cells^2 a step, the one solved
    double length = 0;         ///< reference length in cells
    double sponge = 0;         ///< cells of raised viscosity before the outlet
    double force_unit = 0;     ///< N of one lattice unit
    double cross_section = 0;  ///< of the box, m^2 (section: m^2 over its span)
    std::uint32_t ramp_steps = 0, start_steps = 0, interval_steps = 0, samples = 0;
    Walls walls;
};

/// Checks surface and case and plans the box; allocates nothing of the flow's size. Throws BakeError.
Domain plan_domain(const Surface& surface, const FlowCase& flow_case);

}  // namespace frm::bake::flow
