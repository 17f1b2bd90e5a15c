// From forces in a few directions to forces in all.
#include <algorithm>
#include <cmath>

#include "bake/directions/fit.h"
#include "bake/directions/fluctuations.h"
#include "bake/directions/images.h"
#include "bake/directions/known.h"
#include "bake/directions/region_forces.h"
#include "bake/directions/shape_pressure.h"
#include "bake/directions/transfer.h"
#include "bake/regions/regions.h"
#include "bake/regions/tessellate.h"
#include "core/map/directions.h"
#include "tests/support/catch.h"
#include "tests/support/shapes.h"

using namespace frm;
using namespace frm::bake;

namespace {

/// Pressure on the faces of a box that is 1, 2 and 5 wide, by the square of the velocity across each.
Vec3d law(const Vec3d& e) { return {10 * e.x * std::fabs(e.x), 5 * e.y * std::fabs(e.y), 2 * e.z * std::fabs(e.z)}; }

Symmetry of_a_box() { return find_symmetry(test::box({0.1, 0.2, 0.5})); }

std::vector<SolvedDirection> solve(const std::vector<Vec3d>& directions) {
    std::vector<SolvedDirection> out;
    for (const Vec3d& e : directions) out.push_back({e, law(e), {}});
    return out;
}

double worst_error(const DirectionFit& fit, const std::vector<FitValue>& values) {
    double worst = 0;
    const DirectionSet all(11);
    for (std::uint32_t d = 0; d < all.count(); ++d) {
        const Vec3d e = all.direction(d);
        const std::vector<double> w = fit.weights(e);
        Vec3d sum;
        for (std::size_t i = 0; i < w.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) sum[static_cast<int>(c)] += w[i] * values[i][c];
        worst = std::max(worst, length(sum - law(e)) / 10);
    }
    return worst;
}

}  // namespace

TEST_CASE("a fit goes through what is known, and its doubt is small there alone", "[directions]") {
    std::vector<FitSite> sites;
    std::vector<FitValue> values;
    const DirectionSet set(3);
    for (std::uint32_t d = 0; d < set.count(); ++d) {
        sites.push_back({set.direction(d), d});
        const Vec3d f = law(set.direction(d));
        values.push_back({f.x, f.y, f.z, 0, 0, 0});
    }
    const DirectionFit fit(sites, {1, 1e-8});
    for (std::size_t i = 0; i < sites.size(); ++i) {
        const std::vector<double> w = fit.weights(sites[i].direction);
        for (std::size_t j = 0; j < w.size(); ++j) CHECK(w[j] == Approx(i == j ? 1 : 0).margin(1e-4));
        CHECK(fit.doubt(sites[i].direction) < 1e-3);
    }
    CHECK(fit.doubt(Vec3d{1, 1, 0.2} / std::sqrt(2.04)) > 0.05);

    // What straight lines between the lattice's directions would miss.
    double straight = 0;
    const DirectionSet all(11);
    for (std::uint32_t d = 0; d < all.count(); ++d) {
        const Vec3d e = all.direction(d);
        const DirectionWeights w = set.interpolate(Vec3f(e));
        Vec3d sum;
        for (int k = 0; k < 3; ++k) sum += law(set.direction(w.index[k])) * static_cast<double>(w.weight[k]);
        straight = std::max(straight, length(sum - law(e)) / 10);
    }
    CHECK(worst_error(fit, values) < 0.5 * straight);
}

TEST_CASE("what is left out is predicted as if it had never been there", "[directions]") {
    std::vector<FitSite> sites;
    std::vector<FitValue> values;
    const DirectionSet set(2);
    for (std::uint32_t d = 0; d < set.count(); ++d) {
        sites.push_back({set.direction(d), d / 2});  // pairs
        const Vec3d f = law(set.direction(d));
        values.push_back({f.x, f.y, f.z, 0, 0, 0});
    }
    const FitModel model{1, 1e-3};
    const std::vector<FitValue> left = DirectionFit(sites, model).left_out(values);
    for (std::uint32_t group = 0; group < 9; ++group) {
        std::vector<FitSite> others;
        std::vector<FitValue> known;
        for (std::size_t i = 0; i < sites.size(); ++i) {
            if (sites[i].group == group) continue;
            others.push_back({sites[i].direction, static_cast<std::uint32_t>(others.size())});
            known.push_back(values[i]);
        }
        const DirectionFit without(others, model);
        for (std::size_t i = 0; i < sites.size(); ++i) {
            if (sites[i].group != group) continue;
            const std::vector<double> w = without.weights(sites[i].direction);
            double sum = 0;
            for (std::size_t j = 0; j < w.size(); ++j) sum += w[j] * known[j][0];
            CHECK(left[i][0] == Approx(sum).margin(1e-6));
        }
    }
}

TEST_CASE("what is left out tells the factors of the terms nothing either", "[directions]") {
    std::vector<FitSite> sites;
    std::vector<FitValue> values;
    FitTerms terms;
    const DirectionSet set(2);
    for (std::uint32_t d = 0; d < set.count(); ++d) {
        const Vec3d e = set.direction(d), f = law(e);
        sites.push_back({e, d / 2});  // pairs
        values.push_back({f.x, f.y, f.z, e.x * e.y, 0, 1});
        terms.push_back({{e.x * e.x * e.x, 0, 0, e.y, 0, 0}, {0, e.y * e.z, 1, 0, e.x, 0}});
    }
    const FitModel model{1, 1e-3, true};
    const std::vector<FitValue> left = DirectionFit(sites, model, terms).left_out(values);
    for (std::uint32_t group = 0; group < 9; ++group) {
        std::vector<FitSite> others;
        std::vector<FitValue> known;
        FitTerms known_terms;
        for (std::size_t i = 0; i < sites.size(); ++i) {
            if (sites[i].group == group) continue;
            others.push_back({sites[i].direction, static_cast<std::uint32_t>(others.size())});
            known.push_back(values[i]);
            known_terms.push_back(terms[i]);
        }
        const DirectionFit without(others, model, known_terms);
        const std::vector<double> factors = without.factors(known);
        REQUIRE(factors.size() == 2);
        for (std::size_t i = 0; i < sites.size(); ++i) {
            if (sites[i].group != group) continue;
            const std::vector<double> w = without.weights(sites[i].direction);
            for (std::size_t c = 0; c < 6; ++c) {
                double sum = factors[0] * terms[i][0][c] + factors[1] * terms[i][1][c];
                for (std::size_t j = 0; j < w.size(); ++j)
                    sum += w[j] * (known[j][c] - factors[0] * known_terms[j][0][c] - factors[1] * known_terms[j][1][c]);
                // The prior of the factors is in units of the terms' mean square, which a pair hardly changes.
                CHECK(left[i][c] == Approx(sum).margin(2e-3));
            }
        }
    }
}

TEST_CASE("the shape of a body tells most of how its force changes with the direction", "[directions]") {
    Surface body = test::icosphere(1, 1);
    for (Vec3d& v : body.vertices)
        v = {1.6 * v.x + 0.3 * v.y * v.y, v.y + 0.2 * v.x * v.z, 0.5 * v.z + 0.2 * v.x * v.x};
    const Regions regions = split_regions(body, 12);
    const Vec3d centre = measure(body).centroid;
    // Not one of the terms: stagnation ahead, then as on a sphere, then a wake.
    const auto flow = [&](const Vec3d& e) {
        FlowMeans means;
        means.patch.resize(regions.count);
        for (std::size_t t = 0; t < body.triangles.size(); ++t) {
            const Vec3d n = cross(body.corner(t, 1) - body.corner(t, 0), body.corner(t, 2) - body.corner(t, 0)) * 0.5;
            const Vec3d at = (body.corner(t, 0) + body.corner(t, 1) + body.corner(t, 2)) / 3.0;
            const double c = -dot(n, e) / length(n), pressure = c > 0 ? std::max(-0.4, 1 - 2.25 * (1 - c * c)) : -0.4;
            means.patch[regions.region[t]].pressure -= n * pressure;
            means.torque -= cross(at, n * pressure);
        }
        for (const PatchForce& f : means.patch) means.force += f.pressure;
        return means;
    };
    Symmetry none;
    none.centre = centre;
    std::vector<FlowMeans> means;
    std::vector<SolvedDirection> solved;
    const DirectionSet set(2), dense(5);
    for (std::uint32_t d = 0; d < set.count(); ++d) {
        means.push_back(flow(set.direction(d)));
        solved.push_back(solved_direction(set.direction(d), means.back(), centre));
    }
    const Landing landing(body, 1e-6);
    Transfers transfers({body, regions, regions, centre, landing});
    const RegionForces forces(transfers, none, means, solved, 1, spacing_of(2));
    const KnownForces alone(none, solved, 1, spacing_of(2));
    CHECK(alone.shape_factors().empty());
    CHECK(forces.known().shape_factors().size() == ShapePressure::terms);
    CHECK(forces.known().errors().rms < 0.5 * alone.errors().rms);

    double largest = 0, with = 0, without = 0, torques = 0, torque = 0;
    for (std::uint32_t d = 0; d < dense.count(); ++d) {
        const Vec3d e = dense.direction(d);
        const FlowMeans truth = flow(e);
        Vec3d whole, plain;
        for (const PatchForce& f : forces.mean(e)) whole += f.pressure + f.friction;
        const std::vector<double> w = alone.fit().weights(e);
        for (std::size_t i = 0; i < w.size(); ++i) plain += solved[i].force * w[i];
        largest = std::max(largest, length(truth.force));
        with += dot(whole - truth.force, whole - truth.force);
        without += dot(plain - truth.force, plain - truth.force);
        const Vec3d about = truth.torque - cross(centre, truth.force), off = forces.known().torque(e) - about;
        torques += dot(about, about);
        torque += dot(off, off);
    }
    CHECK(with < 0.25 * without);
    CHECK(torque < 0.05 * torques);
    CHECK(std::sqrt(with / dense.count()) < 0.05 * largest);
}

TEST_CASE("of a box an eighth of the directions is solved, and says as much as all", "[directions]") {
    const Symmetry symmetry = of_a_box();
    const std::vector<Vec3d> few = distinct_directions(symmetry, 3);
    CHECK(few.size() == 10);
    const KnownForces known(symmetry, solve(few), 0.2, spacing_of(3));
    std::size_t sites = 0;
    for (std::size_t k = 0; k < few.size(); ++k) {
        for (const Image& image : known.images_of(k)) {
            for (const Matrix3& g : image.by) CHECK(length(g * few[k] - image.direction) < 1e-9);
            ++sites;
        }
    }
    CHECK(sites == 38);
    // Face on, four isometries leave the direction as it is.
    CHECK(known.images_of(0).front().by.size() == 4);
    CHECK(known.errors().rms < 0.1);
    CHECK(known.errors().worst >= known.errors().rms);
}

TEST_CASE("further directions are asked for where they help", "[directions]") {
    const Symmetry symmetry = of_a_box();
    std::vector<Vec3d> directions = distinct_directions(symmetry, 2);
    double before = 0;
    for (int round = 0; round < 4; ++round) {
        const KnownForces known(symmetry, solve(directions), 0.2, spacing_of(2));
        const double now = known.errors().rms;
        if (round == 0) before = now;
        if (round == 3) CHECK(now < 0.5 * before);
        for (const Vec3d& e : known.next(3)) {
            CHECK(length(e) == Approx(1));
            for (const Vec3d& other : directions) CHECK(apart(symmetry, e, other) > 0.05);
            directions.push_back(e);
        }
    }
}

TEST_CASE("bodies of revolution are solved along half a circle, spheres once", "[directions]") {
    Symmetry round;
    round.kind = SymmetryKind::axial_mirrored;
    round.axis = {0, 0, 1};
    const std::vector<Vec3d> few = distinct_directions(round, 3);
    CHECK(few.size() >= 3);
    CHECK(few.size() <= 6);
    for (const Vec3d& e : few)
        for (const Image& image : images(round, e, spacing_of(3))) {
            CHECK(std::fabs(image.direction.z) == Approx(std::fabs(e.z)).margin(1e-9));
            for (const Matrix3& g : image.by) CHECK(length(g * e - image.direction) < 1e-9);
        }
    round.kind = SymmetryKind::spherical;
    CHECK(distinct_directions(round, 4).size() == 1);
    const auto all = images(round, {1, 0, 0}, spacing_of(3));
    CHECK(all.size() >= 38);
    for (const Image& image : all)
        for (const Matrix3& g : image.by) {
            CHECK(length(g * Vec3d{1, 0, 0} - image.direction) < 1e-9);
            CHECK(std::fabs(determinant(g)) == Approx(1));
        }
}

TEST_CASE("one flow alone tells nothing of its error, and asks for no other", "[directions]") {
    Symmetry round;
    round.kind = SymmetryKind::spherical;
    const std::vector<Vec3d> one = distinct_directions(round, 3);
    REQUIRE(one.size() == 1);
    const KnownForces known(round, solve(one), 0.2, spacing_of(3));
    CHECK(known.errors().rms == 0);
    CHECK(known.errors().worst == 0);
}

namespace {

/// A body without symmetry of which these flows are known, one for each direction of the set.
struct Swinging {
    Swinging(const Surface& surface, const Regions& regions, const DirectionSet& set,
             const std::vector<TaskResult>& flows)
        : landing(surface, 1e-6),
          transfers({surface, regions, regions, {}, landing}),
          forces(transfers, none, means_of_all(flows), solved_of_all(set, flows), 0.2, spacing_of(1)) {
        for (const TaskResult& flow : flows) results.push_back(&flow);
    }

    static std::vector<FlowMeans> means_of_all(const std::vector<TaskResult>& flows) {
        std::vector<FlowMeans> means;
        for (const TaskResult& flow : flows) means.push_back(means_of(flow));
        return means;
    }
    static std::vector<SolvedDirection> solved_of_all(const DirectionSet& set, const std::vector<TaskResult>& flows) {
        std::vector<SolvedDirection> solved;
        for (std::uint32_t d = 0; d < flows.size(); ++d)
            solved.push_back(solved_direction(set.direction(d), means_of(flows[d]), {}));
        return solved;
    }

    Symmetry none;
    Landing landing;
    Transfers transfers;
    RegionForces forces;
    std::vector<const TaskResult*> results;
};

/// Of the sine that swings as strongly as pressure x on a region, read as a tick does: in straight lines from sample to
/// sample.
double amplitude_read(const Fluctuation& f, std::uint32_t region, std::uint32_t samples) {
    constexpr int parts = 16;
    double square = 0;
    for (std::uint32_t s = 0; s < samples; ++s) {
        const auto a = static_cast<double>(f[(region * samples + s) * 6]);
        const auto b = static_cast<double>(f[(region * samples + (s + 1) % samples) * 6]);
        for (int i = 0; i < parts; ++i) square += std::pow(a + (b - a) * (i + 0.5) / parts, 2) / (parts * samples);
    }
    return std::sqrt(2 * square);
}

}  // namespace

TEST_CASE("a quick swing is as strong in straight lines between samples as the flow's", "[directions]") {
    const Surface box = tessellate(test::box({0.1, 0.2, 0.5}), 0.05, 2000).surface;
    const Regions regions = split_regions(box, 1);
    const DirectionSet set(1);
    const std::uint32_t period = 64, samples = 24;
    for (const float harmonic : {1.0f, 4.0f, 9.0f}) {  // 24, 6 and 2.7 samples each
        std::vector<TaskResult> flows(set.count());
        for (TaskResult& r : flows) {
            r.interval = 1;
            r.samples = period + 16;
            r.regions = 1;
            for (std::uint32_t s = 0; s < r.samples; ++s) {
                const float at = 2 * 3.14159265f * static_cast<float>(s) / static_cast<float>(period);
                r.pressure.insert(r.pressure.end(), {std::sin(harmonic * at), 0, 0});
                r.friction.insert(r.friction.end(), 3, 0);
            }
            r.torque.assign(std::size_t{r.samples} * 3, 0);
        }
        const Swinging body(box, regions, set, flows);
        for (const Fluctuation& f : fluctuations(body.forces, body.results, 1, set, {period, samples, 10, 0}))
            CHECK(amplitude_read(f, 0, samples) == Approx(1).epsilon(0.01));
    }
}

TEST_CASE("of a long record the swing has the strength of the whole, not of one period", "[directions]") {
    const Surface box = tessellate(test::box({0.1, 0.2, 0.5}), 0.05, 2000).surface;
    const Regions regions = split_regions(box, 1);
    const DirectionSet set(1);
    const std::uint32_t period = 64, samples = 32;
    std::vector<TaskResult> flows(set.count());
    for (TaskResult& r : flows) {
        r.interval = 1;
        r.samples = 4 * period + period / 4;
        r.regions = 1;
        for (std::uint32_t s = 0; s < r.samples; ++s) {
            const float at = 2 * 3.14159265f * static_cast<float>(s) / static_cast<float>(period);
            // By turns weak and strong.
            const float level = s / period % 2 ? 1.5f : 0.5f;
            r.pressure.insert(r.pressure.end(), {level * std::sin(4 * at), 0, 0});
            r.friction.insert(r.friction.end(), 3, 0);
        }
        r.torque.assign(std::size_t{r.samples} * 3, 0);
    }
    const Swinging body(box, regions, set, flows);
    // Each stretch begins with a seam into its neighbour, which is three times as strong or a third: hence the tolerance.
    for (const Fluctuation& f : fluctuations(body.forces, body.results, 1, set, {period, samples, 10, 0}))
        CHECK(amplitude_read(f, 0, samples) == Approx(std::sqrt((0.25 + 2.25) / 2)).epsilon(0.1));
}

TEST_CASE("a flow that was solved keeps its own swing, whatever its neighbours'", "[directions]") {
    const Surface box = tessellate(test::box({0.1, 0.2, 0.5}), 0.05, 2000).surface;
    const Regions regions = split_regions(box, 6);
    const DirectionSet set(1), dense(2);
    std::vector<TaskResult> flows;
    const std::uint32_t period = 64;
    for (std::uint32_t d = 0; d < set.count(); ++d) {
        TaskResult r;
        r.interval = 1;
        r.samples = period + 16;
        r.regions = 6;
        // The first hardly swings as a whole.
        const float whole = d == 0 ? 1e-4f : 1.0f;
        for (std::uint32_t s = 0; s < r.samples; ++s) {
            const float wave = std::sin(2 * 3.14159265f * 4 * static_cast<float>(s) / static_cast<float>(period));
            for (std::uint32_t l = 0; l < 6; ++l) {
                const float part = l == 0 ? whole : l % 2 ? 0.5f : -0.5f;
                for (int c = 0; c < 3; ++c) r.pressure.push_back(c == 0 ? (l == 5 ? 0 : part) * wave : 0);
                for (int c = 0; c < 3; ++c) r.friction.push_back(0);
            }
        }
        r.torque.assign(std::size_t{r.samples} * 3, 0);
        flows.push_back(r);
    }
    const Swinging body(box, regions, set, flows);
    const PeriodicSpec spec{period, 32, 8, 0};
    const std::vector<Fluctuation> out = fluctuations(body.forces, body.results, 6, dense, spec);
    for (std::uint32_t d = 0; d < dense.count(); ++d) {
        const double first = amplitude_read(out[d], 0, 32), second = amplitude_read(out[d], 1, 32);
        const RegionForces::Nearest from = body.forces.nearest(dense.direction(d));
        if (from.solved) {
            CHECK(first == Approx(from.flow == 0 ? 1e-4 : 1).epsilon(0.01));
            CHECK(second == Approx(0.5).epsilon(0.01));
        }
        CHECK(second < 1.01);
    }
}

TEST_CASE("between flows the swing is what a map has of theirs, not what their records had", "[directions]") {
    const Surface box = tessellate(test::box({0.1, 0.2, 0.5}), 0.05, 2000).surface;
    const Regions regions = split_regions(box, 1);
    const DirectionSet set(1), dense(2);
    const std::uint32_t period = 64;
    const PeriodicSpec spec{period, 32, 8, 0};
    const float turn = 2 * 3.14159265f / static_cast<float>(period);
    std::vector<TaskResult> flows;
    for (std::uint32_t d = 0; d < set.count(); ++d) {
        TaskResult r;
        r.interval = 1;
        r.samples = period + 16;
        r.regions = 1;
        for (std::uint32_t s = 0; s < r.samples; ++s) {
            // The first record has a strong noise as well, far above the highest harmonic that is kept.
            const float at = turn * static_cast<float>(s), noise = d == 0 ? 5 * std::sin(20 * at) : 0;
            r.pressure.insert(r.pressure.end(), {std::sin(4 * at) + noise, 0, 0});
            r.friction.insert(r.friction.end(), 3, 0);
        }
        r.torque.assign(std::size_t{r.samples} * 3, 0);
        flows.push_back(r);
    }
    const Swinging body(box, regions, set, flows);
    const std::vector<Fluctuation> out = fluctuations(body.forces, body.results, 1, dense, spec);
    for (std::uint32_t d = 0; d < dense.count(); ++d) {
        CHECK(amplitude_read(out[d], 0, 32) == Approx(1).epsilon(0.03));
    }
}
