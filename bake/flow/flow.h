// One flow run: the force of a uniform stream on each region of a fixed body, over time. The face of the solver. What
// is behind it (lattice, walls, far field) may change; nothing outside bake/flow includes more than this.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bake/error.h"
#include "bake/flow/machine_memory.h"
#include "bake/mesh/surface.h"
#include "bake/progress.h"

namespace frm::bake {

struct FlowCase {
    Vec3d direction{0, 1, 0};   ///< unit vector; where the water goes, in the mesh's frame
    double speed = 0.5;         ///< of the uniform stream, m/s, > 0; 0 only where the body spins
    double viscosity = 1.0e-6;  ///< kinematic, m^2/s, > 0
    double density = 1000;      ///< kg/m^3, > 0
    double resolution = 24;     ///< finest cells over the reference length, 4 to 512
    /// m; 0: the square root of the projected area (section: the extent across the stream), but for bodies that turn at
    /// most twice the largest distance from the axis.
    double reference_length = 0;
    double start_up = 10;  ///< discarded, in reference lengths travelled by the stream (spin alone: the fastest point)
    double duration = 20;  ///< recorded at most, in the same
    double turn = 0;  ///< degrees by which the lattice is turned about the stream from where it would be put (about
                      ///< the spin in the frame that turns)

    double confidence = 0;  ///< stop once the standard error of the mean drag is below this share; 0: run `duration`
    double seconds = 0;     ///< stop after this wall time, with what there is; 0: no limit
    bool grid_error =
        false;              ///< solve on half the resolution too, which tells the error of the grid; starts from there
    bool pictures = false;  ///< fill FlowSeries::slices

    bool section = false;  ///< solve the cut of the body by the plane through `section_origin`
    Vec3d section_normal{0, 0,
                         1};  ///< unit, across the direction; forces are then per metre of span times `section_span`
    Vec3d section_origin;     ///< a point of the plane, m
    double section_span = 1;  ///< m
    double slab = 0;  ///< section only: solve this many reference lengths of its span in three dimensions, periodic
                      ///< along the normal (wakes above a Reynolds number of 200 need it); 0: two dimensions

    Vec3d spin;         ///< rad/s, about the axis through `spin_centre`; with a stream only of bodies of revolution
    Vec3d spin_centre;  ///< m
    bool turning =
        false;  ///< spin alone: solve in the frame that turns with the body even where it is one of revolution,
                ///< whose wall could move instead (cheaper)

    int threads = 0;  ///< 0: as many as OpenMP gives. The result is the same bits for any number
    /// Bytes; more is refused before anything is allocated. 0: usable_memory().
    std::uint64_t memory_limit = 0;
};

inline std::uint64_t memory_limit_of(const FlowCase& c) {
    return c.memory_limit > 0 ? c.memory_limit : usable_memory();
}

/// A box of the nested grid, in the stream's frame (FlowPlan::axes) about the mesh's origin.
struct FlowBlock {
    Vec3d low, high;  ///< m
    double cell = 0;  ///< m
    std::uint64_t cells = 0;
};

/// What a case will take; known before it runs.
struct FlowPlan {
    double reference_length = 0;  ///< m
    double projected_area = 0;    ///< m^2, across the stream
    double reynolds = 0;          ///< speed * reference_length / viscosity (spin alone: the fastest point's speed)
    double reynolds_solved = 0;   ///< lower than `reynolds` where the lattice cannot carry it
    double blockage = 0;          ///< body's projected area over the domain's cross section
    double cell = 0;              ///< m, the finest
    double time_step = 0;         ///< s, the finest
    std::uint64_t cells = 0;      ///< of all blocks
    std::uint64_t steps = 0;      ///< of the finest block, start-up included
    double updates = 0;           ///< cell updates of the whole run, coarse blocks in their slower time
    std::uint64_t bytes = 0;
    std::array<Vec3d, 3> axes;      ///< the stream's frame in the mesh's: x along the stream; turning: z along the spin
    std::vector<FlowBlock> blocks;  ///< finest first
    std::string warning;            ///< of plan_flow: empty, or what a user should know (thinner than two cells, ...)
};

/// What is not known of the mean drag (of the torque where only spin drives the flow): one standard error or its
/// like, as a share of it.
struct FlowUncertainty {
    double statistics = 0;  ///< of a mean over a finite time
    double grid = -1;       ///< of the finest cell: half of the difference to the run on half the resolution, and what
        ///< boundary layers on round walls may cost that are thinner than cells; negative: not known
    double blockage = 0;   ///< of the far field
    double total() const;  ///< root of the squares of those that are known
};

/// Means on a plane of the stream's frame through the body's middle; NaN inside the body. Values are of the last third
/// of the run.
struct FlowSlice {
    int normal = 2;      ///< axis of the stream's frame across the slice, 1 or 2; rows go along the other one
    Vec3d low;           ///< centre of the first value, in the stream's frame about the mesh's origin, m
    double spacing = 0;  ///< m
    std::uint32_t columns = 0, rows = 0;
    std::vector<float> speed;     ///< [rows][columns], share of the stream's
    std::vector<float> pressure;  ///< [rows][columns], coefficient: gauge pressure over density * speed^2 / 2
};

enum class FlowEnding { duration, confidence, seconds, cancelled };

/// Forces on the body, one sample every `interval` seconds, after the start-up. Blockage is corrected for.
struct FlowSeries {
    FlowPlan plan;
    FlowEnding ending = FlowEnding::duration;
    bool half = false;    ///< ended before the fine run recorded: all of this is of the run on half the resolution
    double interval = 0;  ///< s
    std::uint32_t samples = 0;
    std::uint32_t regions = 0;
    std::vector<float> pressure;  ///< [samples][regions][3], N: normal force, gauge against the far stream (Eq. 3)
    std::vector<float> friction;  ///< [samples][regions][3], N: the rest (Eq. 2)
    std::vector<float> torque;    ///< [samples][3], N m, whole body about the mesh's origin
    FlowUncertainty uncertainty;
    double coarse_drag = 0;  ///< mean force along the stream (spin alone: torque along the axis) on half the
                             ///< resolution, N; 0 without `grid_error`
    std::vector<FlowSlice> slices;
    std::uint64_t steps = 0;  ///< that were done; fewer than planned where it ended early
    double seconds = 0;       ///< wall time
    double mlups = 0;         ///< million lattice cell updates a second
};

class FlowCancelled : public BakeError {
public:
    using BakeError::BakeError;
};

/// Checks the case and says what it takes. Throws BakeError with what to change.
FlowPlan plan_flow(const Surface& surface, const FlowCase& flow_case);

/// How a run stands; called a few times a second. False ends it: with the samples recorded so far, if there are any,
/// else with FlowCancelled.
struct FlowState {
    double share = 0;             ///< of the longest run there may be, 0 to 1
    double seconds_left = 0;      ///< to the end that is expected first; negative: not known yet
    bool recording = false;       ///< false while the flow starts
    bool coarse = false;          ///< the run on half the resolution
    double drag_coefficient = 0;  ///< running mean (while starting: of the last moments); spin alone: of the torque,
                                  ///< T / (density/2 w^2 a^5)
    double statistics = 0;        ///< standard error as a share; 0 while not known
};
using FlowProgress = std::function<bool(const FlowState&)>;

/// Runs the case. Throws BakeError (bad case, out of memory, diverged) or FlowCancelled.
FlowSeries solve_flow(const Surface& surface, const Regions& regions, const FlowCase& flow_case,
                      const FlowProgress& progress);

}  // namespace frm::bake
