// The whole bake, small.
#include "bake/bake.h"

#include <algorithm>

#include "bake/map/formula.h"
#include "bake/tasks/forces.h"
#include "bake/tasks/rounds.h"
#include "core/map/codec.h"
#include "core/map/lookup.h"
#include "tests/support/catch.h"
#include "tests/support/samples.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;

namespace {

BakeOptions small_bake() {
    BakeOptions o;
    o.mesh = test::sample_path("box.glb");
    o.quality = Quality::draft;
    o.directions = 6;
    o.sources = 6;
    o.resolution = 4;
    o.threads = 1;
    return o;
}

Vec3d whole_mean(const Map& map, std::uint32_t direction) {
    Vec3d sum;
    for (std::size_t l = 0; l < map.sources.size(); ++l) {
        const SourceForce& f = map.mean[direction * map.sources.size() + l];
        sum += Vec3d(f.pressure) + Vec3d(f.friction);
    }
    return sum;
}

}  // namespace

TEST_CASE("a bake is the same bytes again, with any number of threads, and pushes along the stream", "[bake]") {
    BakeOptions options = small_bake();
    std::vector<std::uint8_t> first;
    for (const int threads : {1, 2}) {
        options.threads = threads;
        BakePlan plan = plan_bake(options);
        BakeReport report;
        const std::unique_ptr<Map> map = bake::bake(plan, nullptr, report);
        const auto file = encode_map(*map);
        if (first.empty()) {
            first = file;
            // Of a box, three of the six directions along its axes.
            REQUIRE(report.flows.size() == 3);
            double worst = 0;
            for (const BakeReport::Flow& flow : report.flows) {
                // Each is its own mirror image.
                CHECK(flow.images.size() == 2);
                CHECK(flow.left_out >= 0);
                worst = std::max(worst, flow.left_out);
                // A box face-on: 1 to 1.3 in the literature; four cells across are coarse.
                CHECK(flow.drag_coefficient > 0.8);
                CHECK(flow.drag_coefficient < 1.8);
            }
            CHECK(worst == report.direction_errors.worst);
            CHECK(report.added_mass_error > 0);
            CHECK(report.added_mass_error < 0.1);
            for (std::uint32_t d = 0; d < map->directions.count(); ++d) {
                const Vec3d e = map->directions.direction(d);
                const Vec3d force = whole_mean(*map, d);
                CHECK(dot(force, e) > 0);
                // What symmetry says: mirrored streams, mirrored forces.
                Vec3d mirrored = e;
                mirrored.x = -e.x;
                for (std::uint32_t other = 0; other < map->directions.count(); ++other) {
                    if (length(map->directions.direction(other) - mirrored) > 1e-9) continue;
                    const Vec3d f = whole_mean(*map, other);
                    CHECK(length(Vec3d{-f.x, f.y, f.z} - force) < 0.02 * length(force));
                }
            }
            CHECK(map->fluctuation_directions.count() == 6);
            CHECK(map->has_added_mass);
            CHECK(map->facts.quantisation_error < 0.01f);
            CHECK(map->facts.direction_error_rms > 0);
            CHECK(map->shape.volume == Approx(0.024).epsilon(1e-4));
        }
        CHECK(file == first);
    }
}

TEST_CASE("a bake can be cancelled", "[bake]") {
    const BakeOptions options = small_bake();
    BakePlan plan = plan_bake(options);
    BakeReport report;
    CHECK_THROWS_AS(bake::bake(
                        plan, [](double share, const std::string&) { return share < 0.05; }, report),
                    FlowCancelled);
}

TEST_CASE("options that cannot be are named", "[bake]") {
    const auto text_of = [](const BakeOptions& o) -> std::string {
        try {
            plan_bake(o);
        } catch (const BakeError& error) {
            return error.what();
        }
        return "";
    };
    BakeOptions o = small_bake();
    o.directions = 7;
    CHECK(text_of(o).find("--directions 7") != std::string::npos);
    o = small_bake();
    o.sources = 5000;
    CHECK(text_of(o).find("--sources 5000") != std::string::npos);
    o = small_bake();
    o.speeds = {0.5 + 1e-12};  // not told apart in a map's single precision: it would be refused when all is solved
    CHECK(text_of(o).find("--speeds: two are too near") != std::string::npos);
    for (int k = 1; k <= 16; ++k) o.speeds.push_back(k);
    CHECK(text_of(o).find("at most 16") != std::string::npos);
    o = small_bake();
    o.viscosity = 1e-3;
    o.speeds = {1e-5};
    CHECK(text_of(o).find("--speeds 1e-05: flow: Reynolds number") == 0);
    o = small_bake();
    o.quality = Quality::high;  // of its longer series a map cannot hold so many
    o.directions = 1026;
    o.sources = 4096;
    o.triangles = 20000;
    CHECK(text_of(o).find("more than a map holds") != std::string::npos);
    o = small_bake();
    o.mesh = "/nowhere/mesh.glb";
    CHECK(text_of(o).find("/nowhere/mesh.glb") == 0);
    CHECK(frequency_of(18) == 2);
    CHECK(frequency_of(26) == 0);
}

TEST_CASE("a map from a formula drags along the stream", "[bake]") {
    const Map map = formula_map(test::box({0.1, 0.2, 0.3}), 6, 2, 16);
    for (std::uint32_t d = 0; d < map.directions.count(); ++d) {
        Vec3d sum;
        for (std::uint32_t l = 0; l < 6; ++l) sum += Vec3d(map.mean[d * 6 + l].pressure);
        CHECK(dot(sum, map.directions.direction(d)) > 0);
    }
}

TEST_CASE("with symmetry or without, a map says the same", "[bake]") {
    BakeOptions options = small_bake();
    std::vector<Vec3d> force[2];
    for (const bool symmetry : {true, false}) {
        options.symmetry = symmetry;
        BakePlan plan = plan_bake(options);
        CHECK(plan.tasks.size() == (symmetry ? 3u : 6u));
        BakeReport report;
        const std::unique_ptr<Map> map = bake::bake(plan, nullptr, report);
        for (std::uint32_t d = 0; d < map->directions.count(); ++d) force[symmetry].push_back(whole_mean(*map, d));
    }
    double largest = 0, worst = 0;
    for (std::size_t d = 0; d < force[0].size(); ++d) {
        largest = std::max(largest, length(force[0][d]));
        worst = std::max(worst, length(force[1][d] - force[0][d]));
    }
    // Front and back of a box are solved apart without it: their wakes lean to other sides.
    CHECK(worst < 0.1 * largest);
}

TEST_CASE("torques are fitted about the centroid with symmetry or without", "[bake]") {
    BakeOptions options = small_bake();
    const Vec3d centre = plan_bake(options).symmetry.centre;
    options.symmetry = false;
    CHECK(length(plan_bake(options).symmetry.centre - centre) < 1e-9);
    options.mesh = test::sample_path("paddle.glb");
    const BakePlan plan = plan_bake(options);
    CHECK(length(plan.symmetry.centre) > 0.1);  // the frame is that of the hand
    CHECK(length(plan.symmetry.centre - measure(plan.surface).centroid) < 1e-6);
}

TEST_CASE("the flows of further speeds and spins are the same job", "[bake]") {
    BakeOptions options = small_bake();
    options.speeds = {0.1};
    options.spin = true;
    BakePlan plan = plan_bake(options);
    // Three directions at two speeds; about each axis one turn, since a mirror makes the other way of it.
    CHECK(plan.tasks.size() == 9);
    const std::vector<TaskResult> results = solve_rounds(plan, {}, nullptr);
    BakeReport report;
    const std::unique_ptr<Map> map = make_map(plan, results, report);
    CHECK(map->speeds.size() == 2);
    CHECK(map->spin.rate > 0);
    // Of the largest force: a drag that is small beside it may be uncertain by more of itself.
    double most = 0, largest = 0;
    for (std::size_t k = 0; k < results.size(); ++k) {
        const FlowCase& flow = plan.tasks[k].flow;
        if (!plan.tasks[k].is_stream(options.speed)) continue;
        const TaskResult& r = results[k];
        Vec3d mean;
        for (std::size_t i = 0; i < r.pressure.size(); ++i)
            mean[static_cast<int>(i % 3)] += static_cast<double>(r.pressure[i] + r.friction[i]) / r.samples;
        most = std::max(most, r.uncertainty.total() * std::fabs(dot(mean, flow.direction)));
        largest = std::max(largest, length(mean));
    }
    CHECK(report.uncertainty == Approx(most / largest).epsilon(1e-6));
    CHECK(static_cast<double>(map->facts.uncertainty) == Approx(report.uncertainty).epsilon(1e-6));
    REQUIRE(map->spin.force.size() == 6 * map->sources.size());
    // Torque of a turn about -x is that about +x, the other way round.
    const DirectionSet axes(1);
    for (int axis = 0; axis < 3; ++axis) {
        double torque[2] = {}, gross = 0;
        Vec3d net[2];
        for (std::uint32_t d = 0; d < 6; ++d) {
            const Vec3d e = axes.direction(d);
            if (e[axis] == 0) continue;
            for (std::uint32_t l = 0; l < map->source_count(); ++l) {
                const Vec3f w(e * static_cast<double>(map->spin.rate));
                const Vec3f arm = map->sources[l].position - map->spin.centre;
                const SourceForce local = mean_force(*map, l, cross(arm, w));
                const SourceForce& more = map->spin.force[d * map->source_count() + l];
                const Vec3d f(local.pressure + local.friction + more.pressure + more.friction);
                torque[e[axis] > 0] += cross(Vec3d(arm), f)[axis];
                net[e[axis] > 0] += f;
                gross += length(f);
            }
        }
        CHECK(torque[1] < 0);
        // With six sources, whose arms alone would tell another torque than the flow's.
        for (std::size_t k = 0; k < results.size(); ++k) {
            const FlowCase& flow = plan.tasks[k].flow;
            if (plan.tasks[k].kind != TaskKind::spin || flow.spin[axis] == 0) continue;
            const FlowMeans means = means_of(results[k]);
            const Vec3d found = means.torque - cross(flow.spin_centre, means.force);
            CHECK(torque[flow.spin[axis] > 0] == Approx(found[axis]).epsilon(1e-3));
        }
        CHECK(torque[0] == Approx(-torque[1]).epsilon(0.02));
        // Half a turn about the axis and the mirror across it leave nothing to push the box anywhere.
        CHECK(length(net[0]) < 1e-4 * gross);
        CHECK(length(net[1]) < 1e-4 * gross);
    }
}

TEST_CASE("a turn about a long axis has cells across what turns", "[bake]") {
    BakeOptions options = small_bake();
    options.mesh = test::sample_path("paddle.glb");
    options.resolution = 12;
    options.spin = true;
    const BakePlan plan = plan_bake(options);
    const Vec3d centre = measure(plan.surface).centroid;
    int seen = 0;
    for (const Task& task : plan.tasks) {
        CHECK(task.flow.grid_error == (task.kind == TaskKind::stream));
        if (task.kind != TaskKind::spin) continue;
        const Vec3d axis = task.flow.spin / length(task.flow.spin);
        double radius = 0;
        for (const Vec3d& v : plan.surface.vertices) radius = std::max(radius, length(cross(axis, v - centre)));
        INFO(task.name);
        // Twelve across the blade, not across the root of the whole paddle's area; never fewer than of a stream.
        CHECK(2 * radius / task.cost.cell > 11.9);
        CHECK(plan.reference_length / task.cost.cell > 11.9);
        ++seen;
    }
    CHECK(seen == 3);
}

TEST_CASE("a bake's record is of a wake that has forgotten its start", "[bake]") {
    // A slanted plate on a coarse grid, for a draft's start and record, and long after.
    BakeOptions options = small_bake();
    options.mesh = test::sample_path("plate.glb");
    const BakePlan plan = plan_bake(options);
    FlowCase c = plan.tasks.front().flow;
    const double lengths = 60, record = c.duration, start = c.start_up;
    c.direction = Vec3d{0.412, 0.880, 0.234} / length(Vec3d{0.412, 0.880, 0.234});
    c.resolution = 6;
    c.duration = lengths - start;
    c.pictures = false;
    c.threads = 1;
    const FlowSeries series = solve_flow(plan.surface, plan.regions, c, [](const FlowState&) { return true; });
    const double per_length = series.samples / c.duration;
    const auto at = [&](double from) { return static_cast<std::uint32_t>(from * per_length); };
    std::vector<Vec3d> force(series.samples);
    for (std::uint32_t s = 0; s < series.samples; ++s)
        for (std::size_t i = std::size_t{s} * series.regions * 3; i < std::size_t{s + 1} * series.regions * 3; i += 3)
            for (int k = 0; k < 3; ++k)
                force[s][k] += static_cast<double>(series.pressure[i + static_cast<std::size_t>(k)]) +
                               static_cast<double>(series.friction[i + static_cast<std::size_t>(k)]);
    const auto mean = [&](std::uint32_t first, std::uint32_t last) {
        Vec3d sum;
        for (std::uint32_t s = first; s < last; ++s) sum += force[s] / static_cast<double>(last - first);
        return sum;
    };
    const auto swing = [&](std::uint32_t first, std::uint32_t last) {
        const Vec3d middle = mean(first, last);
        double square = 0;
        for (std::uint32_t s = first; s < last; ++s)
            square += dot(force[s] - middle, force[s] - middle) / static_cast<double>(last - first);
        return std::sqrt(square);
    };
    const std::uint32_t all = series.samples, late = at(lengths - start - 25);
    const Vec3d developed = mean(late, all);
    INFO("mean " << length(mean(0, at(record)) - developed) / length(developed) << ", swing " << swing(0, at(record))
                 << " and " << swing(late, all));
    CHECK(length(mean(0, at(record)) - developed) < 0.03 * length(developed));
    CHECK(swing(0, at(record)) < 2 * swing(late, all));
}

TEST_CASE("where symmetry leaves few flows their records are longer, but not a draft's", "[bake]") {
    BakeOptions options;
    options.mesh = test::sample_path("plate.glb");
    options.quality = Quality::standard;
    BakePlan plan = plan_bake(options);
    CHECK(plan.record > 2 * (plan.period + plan.overlap));
    for (const Task& task : plan.tasks) {
        CHECK(task.flow.duration == plan.record);
        CHECK(task.flow.grid_error);
    }
    options.symmetry = false;
    plan = plan_bake(options);
    CHECK(plan.record == plan.period + plan.overlap);
    options.symmetry = true;
    options.quality = Quality::draft;
    plan = plan_bake(options);
    CHECK(plan.record == plan.period + plan.overlap);
}
