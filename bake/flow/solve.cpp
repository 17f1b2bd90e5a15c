// The run: time steps, samples, when to stop, progress, and the guard against divergence.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <memory>
#include <new>
#include <string>
#include <utility>

#include "bake/flow/domain.h"
#include "bake/flow/flow.h"
#include "bake/flow/forces.h"
#include "bake/flow/links.h"
#include "bake/flow/nest.h"
#include "bake/flow/picture.h"
#include "bake/flow/statistics.h"
#include "bake/flow/threads.h"

namespace frm::bake {
namespace flow {
namespace {

using Clock = std::chrono::steady_clock;

// Drag is divided by 1 + factor * Cd * blockage (Maskell's form). In a tunnel with solid walls the factor is 2.8; the
// sides of this box give way a little: 1.8 between boxes of 3 % and of 0.4 % (1.3 for a sphere at Re 100, 2.2 for a
// cube at Re 1e4).
constexpr double blockage_factor = 1.8, section_blockage_factor = 0;
constexpr double least_statistics = 1e-3, least_known = 0.5;  // lengths under which a mean says nothing
constexpr double section_blockage = 0.01;  // three times the room lowers the drag of sections at Re 100 by so much
constexpr double turning_blockage = 0.01;  // more room, 5 by 3 radii, changes the torque by so much
constexpr double grid_share = 0.5;         // of the difference to the run on half the resolution
constexpr std::uint64_t guard_steps = 64;
constexpr double progress_seconds = 0.3;
constexpr double picture_every = 0.5;                   // lengths
constexpr double least_record = 10, check_every = 0.5;  // lengths: of a confidence that counts, and between looks at it

double seconds_since(Clock::time_point then) { return std::chrono::duration<double>(Clock::now() - then).count(); }

class Run {
public:
    /// `before`, `after`: cell updates of other runs that count in the progress shown; `begin`: when all of it began.
    Run(const Domain& domain, const Regions& regions, const FlowCase& c, const FlowProgress& progress, double before,
        double after, Clock::time_point begin)
        : domain_(domain),
          case_(c),
          progress_(progress),
          body_(cut_links(domain, regions)),
          wall_(body_.links, regions.count, Populations::apart(domain.finest())),
          nest_(domain, std::move(body_.solid), wall_, thread_count(c.threads)),
          loads_(regions.count),
          before_(regions.count),
          sample_(regions.count),
          before_updates_(before),
          after_updates_(after),
          begin_(begin),
          started_(Clock::now()) {
        if (wall_.stretches() == 0) {
            throw BakeError("flow: the lattice does not meet the body; raise resolution or check the surface's scale");
        }
    }

    /// Takes over how long a record has to be (--confidence) from another run of the same case.
    void expect_as(const Run& other) {
        scatter_ = other.relative_error() * other.relative_error() * other.recorded_lengths();
    }

    /// Goes on from the flow of another run of the same case, on other cells.
    void start_from(const Run& other) {
        const Domain &d = domain_, &o = other.domain_;
        const double cells = d.plan.cell / o.plan.cell;
        const auto speed = static_cast<float>(d.lattice_speed / o.lattice_speed);
        const Vec3d shift = (d.origin - o.origin) / o.plan.cell;
        nest_.set([&](const Vec3d& point, std::array<float, field_count>& fields) {
            fields.fill(0);
            if (!other.nest_.sample(shift + point * cells, fields)) {
                fields[1] = static_cast<float>(o.stream_speed);
            }
            fields[0] *= speed * speed;
            for (std::size_t i = 1; i < 4; ++i) fields[i] *= speed;
            for (std::size_t i = 4; i < field_count; ++i) fields[i] *= speed * static_cast<float>(cells);
        });
        guarded_ = nest_.step();
    }

    FlowSeries solve() {
        series_.plan = domain_.plan;
        series_.regions = static_cast<std::uint32_t>(loads_.size());
        series_.interval = domain_.interval_steps * domain_.plan.time_step;
        const std::size_t values = std::size_t{3} * domain_.samples * series_.regions;
        series_.pressure.reserve(values);
        series_.friction.reserve(values);
        series_.torque.reserve(std::size_t{3} * domain_.samples);
        measure_.reserve(domain_.samples);

        const std::function<void(std::uint64_t)> after_step = [this](std::uint64_t step) { record(step); };
        while (measure_.size() < domain_.samples) {
            nest_.advance(after_step);
            watch();
            look();
            if (enough()) break;
        }
        if (series_.samples > 0) finish();
        return std::move(series_);
    }

private:
    void record(std::uint64_t step) {
        wall_.sum(loads_);
        now_ = quantity(loads_);
        // Averaged over some twenty steps: the exchange of a single one swings.
        shown_ += 0.05 * (now_ - shown_);
        if (step > domain_.start_steps + 1 && measure_.size() < domain_.samples) {
            // The exchange on walls along the lattice swings every second step; the trapezoid over an interval has no
            // response at that frequency whatever the interval.
            const double share = 0.5 / domain_.interval_steps;
            for (std::size_t r = 0; r < loads_.size(); ++r) {
                sample_[r].add(before_[r], share);
                sample_[r].add(loads_[r], share);
            }
            if ((step - domain_.start_steps - 1) % domain_.interval_steps == 0) store();
        }
        std::swap(before_, loads_);
    }

    bool spins_alone() const { return domain_.stream_speed == 0; }

    /// What the run is about: the drag, or the torque against the spin where there is no stream.
    double quantity(const std::vector<Load>& loads) const {
        Vec3d force, torque;
        for (const Load& load : loads) {
            force += Vec3d{load.force[0], load.force[1], load.force[2]};
            torque += Vec3d{load.torque[0], load.torque[1], load.torque[2]};
        }
        if (!spins_alone()) return force.x;
        const Vec3d centre = domain_.frame.to_stream(case_.spin_centre) / domain_.plan.cell;
        return -dot(torque - cross(centre, force), domain_.spin / length(domain_.spin));
    }

    void store() {
        if (!spins_alone() || domain_.turning)
            wall_.limit_friction(sample_, domain_.lattice_speed, domain_.plan.reynolds);
        measure_.push_back(quantity(sample_));
        Load whole;
        for (Load& load : sample_) {
            whole.add(load, 1);
            const Vec3d pressure = domain_.frame.to_mesh({load.pressure[0], load.pressure[1], load.pressure[2]});
            const Vec3d force = domain_.frame.to_mesh({load.force[0], load.force[1], load.force[2]});
            for (int i = 0; i < 3; ++i) {
                series_.pressure.push_back(static_cast<float>(pressure[i] * domain_.force_unit));
                series_.friction.push_back(static_cast<float>((force[i] - pressure[i]) * domain_.force_unit));
            }
            load = {};
        }
        const Vec3d torque = domain_.frame.to_mesh({whole.torque[0], whole.torque[1], whole.torque[2]});
        for (int i = 0; i < 3; ++i) {
            series_.torque.push_back(static_cast<float>(torque[i] * domain_.force_unit * domain_.plan.cell));
        }
        ++series_.samples;
    }

    void watch() {
        bool sound = std::isfinite(now_);
        if (nest_.step() >= guarded_ + guard_steps) {
            guarded_ = nest_.step();
            sound = sound && nest_.unsound() == 0;
        }
        if (sound) return;
        char text[256];
        std::snprintf(text, sizeof text,
                      "flow: the solution diverged at step %llu of %llu (Reynolds number %.4g on %.4g resolution); "
                      "raise resolution or lower speed",
                      static_cast<unsigned long long>(nest_.step()),
                      static_cast<unsigned long long>(domain_.plan.steps), domain_.plan.reynolds_solved,
                      case_.resolution);
        throw BakeError(text);
    }

    /// Adds to the pictures in the last third of the run.
    void look() {
        if (!case_.pictures || share_done() < 2.0 / 3) return;
        const double lengths = recorded_lengths();
        if (lengths < pictured_ + picture_every) return;
        pictured_ = lengths;
        if (!picture_) picture_ = std::make_unique<Picture>(domain_);
        picture_->add(nest_);
    }

    /// The standard error of the mean drag over time, as a share of it.
    double relative_error() const {
        const double average = mean(measure_);
        return average != 0 ? standard_error(measure_) / std::abs(average) : 1;
    }

    /// What a record of this length leaves of chance by the record of another run of the same case. A wake may wait for
    /// ten lengths before it sheds: by its own record a run past a sphere at Re 1000 knew its drag to 0.1 % after six,
    /// and was 1.7 % off.
    double error_expected() const { return std::sqrt(scatter_ / std::max(recorded_lengths(), 1e-3)); }

    double recorded_lengths() const {
        return static_cast<double>(measure_.size()) * domain_.interval_steps * domain_.lattice_speed / domain_.length;
    }

    /// Looks now and then whether the run may end, and tells how it stands.
    bool enough() {
        const double lengths = recorded_lengths();
        if (case_.confidence > 0 && lengths >= checked_ + check_every) {
            checked_ = lengths;
            const double known = std::max(relative_error(), error_expected());
            // Twice in a row: the error itself is an estimate, and a look at each of many would find it low once.
            const bool met = lengths >= least_record && known <= case_.confidence;
            if (met && met_) return end(FlowEnding::confidence);
            met_ = met;
        }
        if (case_.seconds > 0 && seconds_since(started_) > case_.seconds) {
            if (nothing_is_known()) {
                throw BakeError(
                    "flow: the time given (seconds) ended while the flow was still starting; give more, or "
                    "lower resolution or start_up");
            }
            return end(FlowEnding::seconds);
        }
        if (!progress_ || seconds_since(reported_) < progress_seconds) return false;
        reported_ = Clock::now();
        if (progress_(state())) return false;
        if (nothing_is_known()) throw FlowCancelled("flow: cancelled");
        return end(FlowEnding::cancelled);
    }

    /// Neither from this run nor from one on half the resolution before it.
    bool nothing_is_known() const { return measure_.empty() && before_updates_ == 0; }

    bool end(FlowEnding ending) {
        series_.ending = ending;
        return true;
    }

    FlowState state() const {
        FlowState s;
        const double done = before_updates_ + share_done() * domain_.plan.updates;
        s.share = done / (before_updates_ + domain_.plan.updates + after_updates_);
        s.coarse = after_updates_ > 0;
        s.recording = !measure_.empty();
        const double coefficient = s.recording ? mean(measure_) : shown_;
        s.drag_coefficient = spins_alone() ? torque_coefficient(coefficient) : drag_coefficient(coefficient);
        s.drag_coefficient *= free_stream(s.drag_coefficient);
        if (recorded_lengths() >= 1 && coefficient != 0) s.statistics = relative_error();
        const double elapsed = seconds_since(begin_);
        s.seconds_left = s.share > 0.01 ? elapsed * (1 - s.share) / s.share : -1;
        if (case_.seconds > 0) {
            const double limit = std::max(0.0, case_.seconds - seconds_since(started_));
            s.seconds_left = s.seconds_left < 0 ? limit : std::min(s.seconds_left, limit);
        }
        return s;
    }

    double share_done() const {
        const auto steps = static_cast<double>(nest_.step() - domain_.first_step);
        return std::min(1.0, steps / static_cast<double>(domain_.plan.steps));
    }

    double drag_coefficient(double force) const {
        return 2 * force / (domain_.stream_speed * domain_.stream_speed * domain_.drag_area);
    }
    double torque_coefficient(double torque) const {
        const double radius = domain_.radius / domain_.plan.cell, rate = length(domain_.spin);
        return 2 * torque / (rate * rate * std::pow(radius, 5));
    }
    double blockage_share(double cd) const {
        const double factor = case_.section ? section_blockage_factor : blockage_factor;
        // Maskell's wake is that of a body at rest.
        return domain_.radius > 0 ? 0 : factor * std::max(cd, 0.0) * domain_.plan.blockage;
    }
    double free_stream(double cd) const { return 1 / (1 + blockage_share(cd)); }

    void finish() {
        const double average = mean(measure_);
        const double cd = spins_alone() ? 0 : drag_coefficient(average);
        const auto scale = static_cast<float>(free_stream(cd));
        for (float& v : series_.pressure) v *= scale;
        for (float& v : series_.friction) v *= scale;
        for (float& v : series_.torque) v *= scale;
        series_.uncertainty.statistics = std::max(least_statistics, relative_error());
        if (series_.ending == FlowEnding::confidence)
            series_.uncertainty.statistics = std::max(series_.uncertainty.statistics, error_expected());
        if (recorded_lengths() < least_known) series_.uncertainty.statistics = 1;
        const double least_blockage = case_.section ? section_blockage : domain_.turning ? turning_blockage : 1e-3;
        series_.uncertainty.blockage = std::max(least_blockage, 0.5 * blockage_share(cd));
        if (case_.pictures) {
            if (!picture_) {  // it ended early
                picture_ = std::make_unique<Picture>(domain_);
                picture_->add(nest_);
            }
            series_.slices = picture_->slices();
        }
        series_.steps = nest_.step() - domain_.first_step;
        series_.seconds = seconds_since(started_);
        series_.mlups = domain_.plan.updates * share_done() / series_.seconds * 1e-6;
    }

    const Domain& domain_;
    const FlowCase& case_;
    const FlowProgress& progress_;
    Body body_;
    Wall wall_;
    Nest nest_;
    FlowSeries series_;
    std::vector<double> measure_;  // the quantity, a value a sample, in lattice units
    std::vector<Load> loads_, before_, sample_;
    double now_ = 0, shown_ = 0, checked_ = 0;
    double scatter_ = 0;  // lengths: the square of the relative error of a record, times how long it is
    std::unique_ptr<Picture> picture_;
    double pictured_ = -1e30;
    double before_updates_, after_updates_;
    bool met_ = false;
    std::uint64_t guarded_ = 0;
    Clock::time_point begin_, started_, reported_;
};

/// The mean drag, or the torque (about the mesh's origin) where only spin drives the flow.
double mean_quantity(const FlowSeries& s, const FlowCase& c) {
    double sum = 0;
    if (c.speed == 0) {
        const Vec3d axis = c.spin / length(c.spin);
        for (std::size_t i = 0; i < s.torque.size(); ++i) {
            sum -= static_cast<double>(s.torque[i]) * axis[static_cast<int>(i % 3)];
        }
    } else {
        for (std::size_t i = 0; i < s.pressure.size(); ++i) {
            sum += static_cast<double>(s.pressure[i] + s.friction[i]) * c.direction[static_cast<int>(i % 3)];
        }
    }
    return sum / std::max(s.samples, 1u);
}

FlowSeries solve_twice(const Surface& surface, const Regions& regions, const Domain& domain, const FlowCase& c,
                       const FlowProgress& progress) {
    const Clock::time_point started = Clock::now();
    const FlowCase half = coarser(c);
    const Domain coarse_domain = plan_domain(surface, half);
    auto coarse = std::make_unique<Run>(coarse_domain, regions, half, progress, 0, domain.plan.updates, started);
    FlowSeries first = coarse->solve();
    if (first.ending == FlowEnding::cancelled) {
        first.half = true;
        return first;
    }
    FlowCase rest = c;
    if (c.seconds > 0) rest.seconds = std::max(1e-3, c.seconds - seconds_since(started));
    Run run(domain, regions, rest, progress, coarse_domain.plan.updates, 0, started);
    if (domain.first_step > 0) run.start_from(*coarse);
    run.expect_as(*coarse);
    coarse.reset();
    FlowSeries series = run.solve();
    if (series.samples == 0) {  // what is known is of the first run
        first.half = true;
        first.ending = series.ending;
        first.seconds = seconds_since(started);
        return first;
    }
    series.coarse_drag = mean_quantity(first, c);
    const double fine = mean_quantity(series, c);
    if (fine != 0) {
        series.uncertainty.grid = std::hypot(grid_share * (1 - series.coarse_drag / fine), domain.layer_error);
    }
    series.seconds = seconds_since(started);
    return series;
}

}  // namespace
}  // namespace flow

double FlowUncertainty::total() const {
    const double g = std::max(grid, 0.0);
    return std::sqrt(statistics * statistics + g * g + blockage * blockage);
}

FlowPlan plan_flow(const Surface& surface, const FlowCase& flow_case) {
    flow::Domain domain = flow::plan_domain(surface, flow_case);
    domain.plan.warning = flow::advice(surface, flow_case, domain);
    return domain.plan;
}

FlowSeries solve_flow(const Surface& surface, const Regions& regions, const FlowCase& flow_case,
                      const FlowProgress& progress) {
    const flow::Domain domain = flow::plan_domain(surface, flow_case);
    if (regions.region.size() != surface.triangles.size()) {
        throw BakeError("flow: regions name " + std::to_string(regions.region.size()) +
                        " triangles and the surface has " + std::to_string(surface.triangles.size()));
    }
    for (const std::uint32_t region : regions.region) {
        if (region >= regions.count) {
            throw BakeError("flow: a triangle is in region " + std::to_string(region) + " of " +
                            std::to_string(regions.count));
        }
    }
    const double series_bytes = 6.0 * sizeof(float) * domain.samples * regions.count;
    if (static_cast<double>(domain.plan.bytes) + series_bytes > static_cast<double>(memory_limit_of(flow_case))) {
        throw BakeError("flow: the record of " + std::to_string(regions.count) + " regions takes " +
                        std::to_string(static_cast<std::uint64_t>(series_bytes) >> 20) +
                        " MiB more than memory_limit leaves; lower duration");
    }
    try {
        if (!flow::runs_coarse(flow_case))
            return flow::Run(domain, regions, flow_case, progress, 0, 0, flow::Clock::now()).solve();
        return flow::solve_twice(surface, regions, domain, flow_case, progress);
    } catch (const std::bad_alloc&) {
        throw BakeError("flow: out of memory; " + std::to_string(domain.plan.bytes >> 20) +
                        " MiB are needed: lower resolution");
    }
}

}  // namespace frm::bake
