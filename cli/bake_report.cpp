#include "cli/bake_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <nlohmann/json.hpp>

#include "bake/report_json.h"
#include "bake/tasks/forces.h"
#include "cli/bake_output.h"
#include "cli/file.h"
#include "cli/flow_results.h"
#include "cli/progress.h"
#include "cli/report.h"

namespace frm::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* page_name = "report.html";
constexpr const char* json_name = "bake.json";
constexpr const char* data_name = "bake.f32";
constexpr const char* format = "frm bake report 1";
constexpr std::uint32_t most_columns = 180;  ///< of a slice: pictures of the page are small
constexpr double none = std::numeric_limits<double>::quiet_NaN();

const ReportKind& kind() {
    static const ReportKind kind{{json_name, data_name, page_name}, format};
    return kind;
}

/// The numbers of bake.f32, and where each array begins.
class Data {
public:
    void begin() { first_ = bytes_.size(); }
    void add(double value) {
        const auto number = static_cast<float>(value);
        bytes_.append(reinterpret_cast<const char*>(&number), sizeof number);
    }
    void add(const Vec3d& v) { add(v.x), add(v.y), add(v.z); }
    /// Describes what was added since begin(): rows of `width` numbers.
    Json end(std::size_t width) const {
        return {{"offset", first_ / sizeof(float)},
                {"shape", {(bytes_.size() - first_) / sizeof(float) / width, width}}};
    }
    const std::string& bytes() const { return bytes_; }

private:
    std::string bytes_;
    std::size_t first_ = 0;
};

Json body_of(const bake::BakePlan& plan) {
    const bake::SurfaceProperties shape = bake::measure(plan.surface);
    return {{"low", json_of(shape.low)},
            {"high", json_of(shape.high)},
            {"centroid", json_of(shape.centroid)},
            {"area", shape.area},
            {"volume", shape.volume},
            {"triangles", plan.surface.triangles.size()},
            {"sources", plan.regions.count},
            {"patches", plan.patches.count},
            {"symmetry", bake::describe(plan.symmetry)}};
}

Json options_of(const bake::BakePlan& plan) {
    const bake::BakeOptions& o = plan.options;
    return {{"quality", bake::name_of(o.quality)},
            {"scale", o.scale},
            {"speed", o.speed},
            {"speeds", plan.speeds},
            {"spin", o.spin},
            {"density", o.density},
            {"viscosity", o.viscosity},
            {"directions", o.directions},
            {"sources", o.sources},
            {"resolution", plan.tasks.front().flow.resolution},
            {"symmetry", o.symmetry},
            {"added_mass", o.added_mass},
            {"threshold", o.threshold},
            {"start_up", plan.start_up},
            {"period", plan.period},
            {"overlap", plan.overlap},
            {"harmonics", plan.harmonics}};
}

Json map_of(const MadeMap& made) {
    const Map& map = made.map;
    Json j{{"file", made.file},
           {"bytes", made.file_bytes},
           {"directions", map.directions.count()},
           {"frequency", map.directions.frequency()},
           {"fluctuation_directions", map.fluctuation_directions.count()},
           {"fluctuation_frequency", map.fluctuation_directions.frequency()},
           {"samples", map.samples},
           {"period", map.facts.period},
           {"reference_length", made.plan.reference_length},
           {"reynolds", map.facts.reynolds},
           {"reynolds_solved", map.facts.reynolds_solved},
           {"spin_rate", made.plan.spin_rate}};
    if (map.has_added_mass) j["added_mass"] = map.added_mass;
    return j;
}

/// The one in which the force swings most.
const bake::FlowSlice* slice_of(const bake::TaskResult& result, const Vec3d& lift_axis) {
    const bake::FlowSlice* best = nullptr;
    double most = -1;
    for (const bake::FlowSlice& slice : result.slices) {
        const double along = std::fabs(dot(result.plan.axes[static_cast<std::size_t>(3 - slice.normal)], lift_axis));
        if (along <= most) continue;
        most = along;
        best = &slice;
    }
    return best;
}

/// The slice's speed, thinned to what a small picture shows.
Json add_slice(Data& data, const bake::FlowSlice& slice) {
    const std::uint32_t stride = (slice.columns + most_columns - 1) / most_columns;
    std::uint32_t columns = 0;
    data.begin();
    for (std::uint32_t row = 0; row < slice.rows; row += stride) {
        columns = 0;
        for (std::uint32_t column = 0; column < slice.columns; column += stride, ++columns)
            data.add(static_cast<double>(slice.speed[std::size_t{row} * slice.columns + column]));
    }
    Json j = data.end(columns);
    j["normal"] = slice.normal;
    j["low"] = json_of(slice.low);
    j["spacing"] = slice.spacing * stride;
    return j;
}

Json flow_of(Data& data, const MadeMap& made, std::size_t k) {
    const bake::Task& task = made.plan.tasks[k];
    const bake::TaskResult& result = made.results[k];
    const bake::BakeReport::Flow& known = made.report.flows[k];
    const FlowResults values = evaluate(made.plan.surface, task.flow, result, made.plan.reference_length);
    Json j{{"name", task.name},
           {"kind", task.kind == bake::TaskKind::spin ? "spin" : "stream"},
           {"direction", json_of(known.direction)},
           {"speed", known.speed},
           {"fastest", values.speed},
           {"left_out", known.left_out < 0 ? none : known.left_out},
           {"lift_axis", json_of(values.lift_axis)}};
    j.update(json_of(result, values));
    j.erase("blocks");
    j["reference_length"] = result.plan.reference_length;
    for (const Vec3d& axis : result.plan.axes) j["axes"].push_back(json_of(axis));
    data.begin();
    for (const Vec3d& e : known.images) data.add(e);
    j["images"] = data.end(3);
    data.begin();
    const std::vector<Vec3d> force = bake::whole_force(result);
    for (std::size_t s = 0; s < force.size(); ++s) {
        data.add(force[s]);
        for (std::size_t c = 0; c < 3; ++c) data.add(static_cast<double>(result.torque[3 * s + c]));
    }
    j["series"] = data.end(6);
    if (const bake::FlowSlice* slice = slice_of(result, values.lift_axis)) j["slice"] = add_slice(data, *slice);
    return j;
}

Json surface_of(Data& data, const Map& map) {
    Json j;
    data.begin();
    for (const Vec3f& v : map.vertices) data.add(Vec3d(v));
    j["vertices"] = data.end(3);
    data.begin();
    for (const auto& triangle : map.triangles)
        for (const std::uint32_t corner : triangle) data.add(corner);
    j["triangles"] = data.end(3);
    data.begin();
    for (const std::uint32_t first : map.region_begin) data.add(first);
    j["region_begin"] = data.end(1);
    data.begin();
    for (const Source& source : map.sources) data.add(Vec3d(source.position)), data.add(Vec3d(source.normal));
    j["sources"] = data.end(6);
    return j;
}

/// What the map holds of the force on the whole body, over the sphere of directions.
void add_sphere(Json& j, Data& data, const MadeMap& made) {
    const Map& map = made.map;
    const std::size_t sources = map.sources.size(), count = map.directions.count();
    data.begin();
    for (std::size_t d = 0; d < count; ++d) {
        Vec3d force;
        for (std::size_t l = 0; l < sources; ++l) {
            const SourceForce& f = map.mean[(map.base * count + d) * sources + l];
            force += Vec3d(f.pressure) + Vec3d(f.friction);
        }
        data.add(map.directions.direction(static_cast<std::uint32_t>(d)));
        data.add(force);
    }
    j["means"] = data.end(6);
    const DirectionSet& set = map.fluctuation_directions;
    data.begin();
    for (std::uint32_t d = 0; d < set.count(); ++d) data.add(set.direction(d));
    j["fluctuation_directions"] = data.end(3);
    data.begin();
    for (const bake::Fluctuation& f : made.tables.fluctuation) {
        for (std::size_t s = 0; s < map.samples; ++s) {
            Vec3d force;
            for (std::size_t l = 0; l < sources; ++l)
                for (std::size_t c = 0; c < Map::components; ++c)
                    force[static_cast<int>(c % 3)] +=
                        static_cast<double>(f[(l * map.samples + s) * Map::components + c]);
            data.add(force);
        }
    }
    j["fluctuations"] = data.end(3);
    data.begin();
    for (std::uint32_t f = 0; f < set.faces(); ++f)
        for (const std::uint32_t corner : set.corners(f)) data.add(corner);
    j["fluctuation_faces"] = data.end(3);
}

}  // namespace

BakePage::BakePage(const std::string& folder, const std::vector<std::string>& others)
    : name_(folder), folder_(folder, kind(), others) {
    const std::string missing = missing_report_tools();
    if (!missing.empty()) print_note("--report: " + missing + ". The bake goes on: the map and the data need neither");
}

void BakePage::write(const MadeMap& made) {
    const ProgressBar catches_interrupts("report");
    Data data;
    Json j{{"format", format},
           {"mesh", made.plan.options.mesh},
           {"mesh_hash", made.plan.mesh_hash},
           {"notes", made.plan.notes},
           {"seconds", made.seconds},
           {"options", options_of(made.plan)},
           {"body", body_of(made.plan)},
           {"map", map_of(made)}};
    j.update(bake::errors_json(made.plan, made.map, made.report));
    j["surface"] = surface_of(data, made.map);
    add_sphere(j, data, made);
    for (std::size_t k = 0; k < made.results.size(); ++k) j["flows"].push_back(flow_of(data, made, k));
    write_file(folder_.temporary() / data_name, data.bytes());
    write_file(folder_.temporary() / json_name, j.dump(1) + "\n");
    problem_ = missing_report_tools();
    if (problem_.empty()) {
        try {
            write_bake_page(folder_.temporary());
        } catch (const Failure& failure) {
            problem_ = failure.what();
        }
    }
    folder_.publish();
    if (!problem_.empty())
        problem_ = "--report: the map is written, and the data in " + name_ + ", but not the page: " + problem_ +
                   ". Then: " + report_command("frm.bake_report", name_);
}

std::vector<std::string> BakePage::files(const std::string& folder) {
    return folder.empty() ? std::vector<std::string>() : ReportFolder::paths(folder, kind());
}

void add_report_option(CLI::App& command, std::string& folder) {
    command
        .add_option("--report", folder,
                    "write report.html, what one would look at before trusting the map, and the\n"
                    "data that it was drawn from to this folder (needs python3-matplotlib)")
        ->check(not_empty())
        ->type_name("DIR");
}

void end_report(const BakePage& page, const std::string& folder, bool json) {
    if (!page.problem().empty()) throw Failure(page.problem());
    if (!json) std::printf("report in %s/report.html\n", folder.c_str());
}

}  // namespace frm::cli
