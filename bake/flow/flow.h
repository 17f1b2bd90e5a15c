// One flow run: the force of a uniform stream on each region of a fixed body, over time. The face of the solver. What
// is behind it (lattice, walls, far field) may change; nothing outside bake/flow includes more than this.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bake/error.h"
#include "bake/mesh/surface.h"
#include "bake/progress.h"

namespace frm::bake {

struct FlowCase {
    Vec3d direction{0, 1, 0};   ///< unit vector; where the water goes, in the mesh's frame
    double speed = 0.5;         ///< of the uniform stream, m/s, > 0
    double viscosity = 1.0e-6;  ///< kinematic, m^2/s, > 0
    double density = 1000;      ///< kg/m^3, > 0
    double resolution = 16;     ///< lattice cells over the reference length, 4 to 512
    double reference_length =
        0;                 ///< m; 0: the square root of the projected area (section: the extent across the stream)
    double start_up = 10;  ///< discarded, in reference lengths travelled by the stream
    double duration = 20;  ///< recorded, in reference lengths travelled by the stream
    bool section = false;  ///< solve in two dimensions: the cut of the body by the plane through `section_origin`
    Vec3d section_normal{0, 0,
                         1};  ///< unit, across the direction; forces are then per metre of span times `section_span`
    Vec3d section_origin;     ///< a point of the plane, m
    double section_span = 1;  ///< m
    int threads = 0;          ///< 0: as many as OpenMP gives. The result is the same bits for any number
    std::uint64_t memory_limit = std::uint64_t{8} << 30;  ///< bytes; more is refused before anything is allocated
};

/// What a case will take; known before it runs.
struct FlowPlan {
    double reference_length = 0;  ///< m
    double projected_area = 0;    ///< m^2, across the stream
    double reynolds = 0;          ///< speed * reference_length / viscosity
    double reynolds_solved = 0;   ///< lower than `reynolds` where the lattice cannot carry it
    double blockage = 0;          ///< body's projected area over the domain's cross section
    double cell = 0;              ///< m, the finest
    double time_step = 0;         ///< s
    std::uint64_t cells = 0;
    std::uint64_t steps = 0;  ///< lattice time steps, start-up included
    std::uint64_t bytes = 0;
    std::string warning;  ///< empty, or what a user should know (thinner than two cells, ...)
};

/// Forces on the body, one sample every `interval` seconds, after the start-up. Blockage is corrected for.
struct FlowSeries {
    FlowPlan plan;
    double interval = 0;  ///< s
    std::uint32_t samples = 0;
    std::uint32_t regions = 0;
    std::vector<float> pressure;  ///< [samples][regions][3], N: normal force, gauge against the far stream (Eq. 3)
    std::vector<float> friction;  ///< [samples][regions][3], N: the rest (Eq. 2)
    std::vector<float> torque;    ///< [samples][3], N m, whole body about the mesh's origin
    double uncertainty = 0;       ///< one standard error of the mean force along the stream, as a share of it
    double seconds = 0;           ///< wall time
    double mlups = 0;             ///< million lattice cell updates a second
};

class FlowCancelled : public BakeError {
public:
    using BakeError::BakeError;
};

/// Checks the case and says what it takes. Throws BakeError with what to change.
FlowPlan plan_flow(const Surface& surface, const FlowCase& flow_case);

/// Runs the case. Throws BakeError (bad case, out of memory, diverged) or FlowCancelled (progress returned false).
FlowSeries solve_flow(const Surface& surface, const Regions& regions, const FlowCase& flow_case,
                      const Progress& progress);

}  // namespace frm::bake
