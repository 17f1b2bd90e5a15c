// The whole bake: mesh -> surface -> patches -> flows (tasks) -> map. A plan says what to compute, tasks compute it in
// any order, and what they found makes the map or asks for more of them.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "bake/directions/known.h"
#include "bake/map/fill.h"
#include "bake/symmetry/symmetry.h"
#include "bake/tasks/task.h"
#include "core/map/map.h"

namespace frm::bake {

enum class Quality { draft, standard, high };
constexpr Quality kQualities[] = {Quality::draft, Quality::standard, Quality::high};

/// "draft", "standard" or "high".
const char* name_of(Quality quality);
/// The quality of that name; standard for any other word.
Quality quality_of(const std::string& name);
/// What RegionBudget::error is at that quality.
double region_error_of(Quality quality);

/// Of the error of rounding the tables, share of the largest force.
constexpr double kRoundingBudget = 5e-3;
/// A mean drag that is less sure than this is told.
constexpr double kNotedUncertainty = 0.1;

struct BakeOptions {
    std::string mesh;  ///< path of a .glb or .gltf
    double scale = 1;  ///< what the mesh's coordinates are multiplied by to be metres
    Quality quality = Quality::standard;
    double speed = 0.5;            ///< u0, m/s
    double density = 1000;         ///< kg/m^3
    double viscosity = 1e-6;       ///< kinematic, m^2/s
    std::vector<double> speeds;    ///< further ones, m/s: what the map holds beyond one Reynolds number
    bool spin = false;             ///< solve rotation about three axes too
    bool added_mass = true;        ///< by potential flow
    bool symmetry = true;          ///< use what symmetry the mesh has; false: solve every direction
    std::uint32_t directions = 0;  ///< 4 n^2 + 2: 6, 18, 38, 66, 102 ..., no more and no fewer; 0: by quality, and more
                                   ///< where the force bends
    std::uint32_t sources = 0;     ///< 1 to 4096; 0: by quality
    double resolution = 0;         ///< grid cells across the reference length; 0: by quality
    std::uint32_t triangles = 0;   ///< most sample triangles; 0: 2,000
    double threshold = 2e-4;       ///< harmonics below this share of the largest mean force are dropped (paper, 5.2)
    int threads = 0;               ///< of bake() alone; the map does not depend on it
};

/// What the options come to for this mesh; known before the hours begin. The same options and mesh give the same plan
/// on every machine.
struct BakePlan {
    BakeOptions options;
    std::string mesh_hash;           ///< of the file's bytes
    Surface surface;                 ///< tessellated
    Symmetry symmetry;               ///< what the plan makes use of
    Regions patches;                 ///< what a flow's forces are recorded on
    Regions regions;                 ///< the haptic regions: what the map stores
    std::vector<std::string> notes;  ///< repairs and warnings for the user
    DirectionSet directions;         ///< of the map's means
    DirectionSet fluctuation_directions;
    DirectionErrors budget;             ///< more directions are solved until the errors are below; zero: none are
    std::uint32_t most_directions = 0;  ///< that are solved at the base speed
    double spacing = 0;                 ///< of the first directions, radians
    std::vector<double> speeds;         ///< all, rising
    double spin_rate = 0;               ///< rad/s; 0: no spins
    double reference_length = 0;        ///< m
    double start_up = 0, period = 0, overlap = 0;  ///< reference lengths travelled
    double record = 0;                             ///< of each flow, after its start: a period and the overlap or more
    std::uint32_t harmonics = 0, samples = 0;
    std::vector<Task> tasks;  ///< of the first round, and of those that extend_plan() added
};

/// What a person would want to know before trusting a map.
struct BakeReport {
    struct Flow {
        std::string name;
        Vec3d direction;              ///< of a spin: its axis
        double speed = 0;             ///< m/s; of a spin: rad/s
        double drag_coefficient = 0;  ///< on the projected area; 0 for a spin
        double uncertainty = 0;       ///< standard error of the mean drag (a spin's torque), share
        // Of a stream's mean force, among those of its speed:
        std::vector<Vec3d> images;  ///< where the body's symmetry makes it known, its own direction first
        double left_out =
            -1;  ///< its error as all others predict it, share of the largest force; negative: there are none
    };
    std::vector<Flow> flows;           ///< one a task
    DirectionErrors direction_errors;  ///< of the base speed's means, each flow predicted from the others
    double uncertainty = 0;  ///< standard error of the worst mean drag at the base speed, share of the largest force
    double added_mass_error = 0;  ///< AddedMass::error
};

/// Throws BakeError or MeshError, naming what cannot be.
BakePlan plan_bake(const BakeOptions& options);

/// After all tasks are done: adds the tasks that their results ask for (results[k] is of tasks[k]). False if there are
/// none: the map can be made.
bool extend_plan(BakePlan& plan, const std::vector<TaskResult>& results);

/// How many tasks a plan can come to at most, all rounds together.
std::size_t most_tasks(const BakePlan& plan);

/// The map of a plan whose tasks are all done. The same bytes wherever and in whatever order they were. `raw` gets the
/// tables before they are rounded.
std::unique_ptr<Map> make_map(const BakePlan& plan, const std::vector<TaskResult>& results, BakeReport& report,
                              Tables* raw = nullptr);

/// All of it, in memory: rounds of tasks until the plan asks for no more, then the map. `progress` gets the share done, 0 to
/// 1, and a note, from any thread; returning false cancels (FlowCancelled).
std::unique_ptr<Map> bake(BakePlan& plan, const Progress& progress, BakeReport& report);

/// The surface of a mesh file, scaled, closed and oriented; what was repaired is appended to `notes`.
Surface load_surface(const std::string& path, std::vector<std::string>& notes, double scale = 1);

/// "6, 18, 38, 66, 102, ..." and the frequency of a count; 0 if it is not one of them.
std::uint32_t frequency_of(std::uint32_t directions);

}  // namespace frm::bake
