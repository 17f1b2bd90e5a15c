// The whole bake: mesh -> surface -> regions -> a flow for every direction -> periodic series -> map.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bake/flow/flow.h"
#include "core/map/map.h"

namespace frm::bake {

enum class Quality { draft, standard, high };

struct BakeOptions {
    std::string mesh;  ///< path of a .glb or .gltf
    Quality quality = Quality::standard;
    double speed = 0.5;            ///< u0, m/s
    double density = 1000;         ///< kg/m^3
    double viscosity = 1e-6;       ///< kinematic, m^2/s
    std::uint32_t directions = 0;  ///< 4 n^2 + 2: 6, 18, 38, 66, 102 ...; 0: by quality
    std::uint32_t sources = 0;     ///< 1 to 4096; 0: by quality
    double resolution = 0;         ///< grid cells across the reference length; 0: by quality
    std::uint32_t triangles = 0;   ///< most sample triangles; 0: 2,000
    int threads = 0;
};

/// What the options come to for this mesh; known before the hours begin.
struct BakePlan {
    Surface surface;  ///< tessellated
    Regions regions;
    std::vector<std::string> notes;  ///< repairs and warnings for the user
    DirectionSet directions;
    double reference_length = 0;                   ///< m
    double start_up = 0, period = 0, overlap = 0;  ///< reference lengths travelled
    std::uint32_t harmonics = 0, samples = 0;
    std::vector<FlowCase> cases;  ///< one a direction
    std::vector<FlowPlan> flows;
    double cell_updates = 0;  ///< all cases together
};

struct DirectionReport {
    Vec3d direction;
    double drag_coefficient = 0;  ///< on the projected area
    double uncertainty = 0;       ///< standard error of the mean drag, share
    double seconds = 0;
    double mlups = 0;
};

struct BakeReport {
    std::vector<DirectionReport> directions;
    double seconds = 0;
};

/// How a bake tells what it is doing: share done, 0 to 1, and a note. Returning false cancels (FlowCancelled).
BakePlan plan_bake(const BakeOptions& options);
std::unique_ptr<Map> bake(const BakeOptions& options, const BakePlan& plan, const Progress& progress,
                          BakeReport& report);

/// The surface of a mesh file, closed and oriented; what was repaired is appended to `notes`.
Surface load_surface(const std::string& path, std::vector<std::string>& notes);

/// "6, 18, 38, 66, 102, ..." and the frequency of a count; 0 if it is not one of them.
std::uint32_t frequency_of(std::uint32_t directions);

}  // namespace frm::bake
