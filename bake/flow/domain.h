// From a case in metres to nested blocks of cells: the frame of the stream, how far each block reaches, and the units
// of the lattice.
#pragma once

#include <array>
#include <string>
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

/// What of the body meets the water, in finest cells: node (i, j, k) of the finest block sits at (i, j, k). For a
/// section these are the walls of a prism one cell high over the outline, open at the ends.
struct Walls {
    std::vector<Vec3d> vertices;
    std::vector<Triangle> triangles;
    std::vector<std::uint32_t> source;  ///< the surface's triangle behind each of `triangles`
};

/// A block and where it lies: node (i, j, k) is at (first + (i, j, k)) 2^level finest cells from the lattice's origin,
/// so that every second node of a block is a node of the next coarser one.
struct Block {
    Grid grid;
    std::array<int, 3> first{};
};

struct Domain {
    FlowPlan plan;
    Frame frame;
    std::vector<Block> blocks;  ///< finest first; each holds the one before it with a margin
    Vec3d origin;               ///< of the lattice, in the stream's frame, m
    double speed = 0;           ///< what lengths travelled are counted with, m/s: the stream's, or the spin's fastest
    double lattice_speed = 0;   ///< the same in cells a step
    double stream_speed = 0;    ///< cells a step
    double viscosity = 0;       ///< finest cells^2 a step, the one solved
    double length = 0;          ///< reference length in finest cells
    double bulk = 0;            ///< size of the body in finest cells: root of its projected area, a section's height
    double sponge = 0;          ///< coarsest cells of raised viscosity before the outlet (turning: behind all faces)
    double force_unit = 0;      ///< N of one lattice unit
    double drag_area = 0;       ///< projected area in the units of a lattice force: 2 F / (u^2 drag_area) is Cd
    double layer_error = 0;     ///< share of the drag that boundary layers thinner than cells may cost
    double radius = 0;          ///< largest distance from the spin's axis, m
    bool turning = false;       ///< the lattice turns with the body, about z
    double reach = 0;           ///< turning: from the axis to where the water is held at rest, finest cells
    Vec3d spin;                 ///< stream's frame, radians a finest step
    Vec3d spin_centre;          ///< finest cells from node (0, 0, 0) of the finest block
    /// The clock's first step (beyond the ramp where the flow starts from another run's), when the ramp of the stream
    /// ends, and when the series begins.
    std::uint64_t first_step = 0, ramp_steps = 0, start_steps = 0;
    std::uint32_t interval_steps = 0, samples = 0;
    Walls walls;

    int levels() const { return static_cast<int>(blocks.size()); }
    const Grid& finest() const { return blocks.front().grid; }
    double relaxation(int level) const { return 0.5 + 3 * viscosity / (1 << level); }
    /// From the lattice's origin, in finest cells.
    Vec3d node(int level, int i, int j, int k) const {
        const std::array<int, 3>& f = blocks[static_cast<std::size_t>(level)].first;
        const double s = 1 << level;
        return {s * (f[0] + i), s * (f[1] + j), s * (f[2] + k)};
    }
};

/// The run on half the resolution that tells the grid's error and, but for slabs, gives the finer one its start; whether there
/// is one.
FlowCase coarser(const FlowCase& flow_case);
bool runs_coarse(const FlowCase& flow_case);

/// What a user should know of a planned case: parts thinner than two cells and the like; empty if there is nothing. Apart
/// from the plan because it looks through the whole surface, and a run does not need it.
std::string advice(const Surface& surface, const FlowCase& flow_case, const Domain& domain);

/// Checks surface and case and plans the blocks; allocates nothing of the flow's size. Throws BakeError.
Domain plan_domain(const Surface& surface, const FlowCase& flow_case);

}  // namespace frm::bake::flow
