// The run: time steps, samples, progress, and the guard against divergence.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <new>
#include <string>
#include <utility>

#ifdef _OPENMP
#include <omp.h>
#endif

#include "bake/flow/domain.h"
#include "bake/flow/far_field.h"
#include "bake/flow/flow.h"
#include "bake/flow/forces.h"
#include "bake/flow/kernel.h"
#include "bake/flow/links.h"
#include "bake/flow/statistics.h"

namespace frm::bake {
namespace flow {
namespace {

using Clock = std::chrono::steady_clock;

// Smagorinsky's constant: that of channels. 0.17, of isotropic turbulence, made a sphere's drag at Re 1000 8 % higher.
constexpr double smagorinsky = 0.1;
// Drag is divided by 1 + factor * Cd * blockage (Maskell's form). In a tunnel with solid walls the factor is 2.8; the
// sides of this box give way a little. Against a box with an eighth of the effect it is 1.3 for a sphere at Re 100 and
// 2.2 for a cube at Re 1e4. A section at 2.5 % and at 1 % has the same drag to 0.1 %.
constexpr double blockage_factor = 1.8, section_blockage_factor = 0;
constexpr double sway_y = 0.05, sway_z = 0.03;  // of the stream's speed
constexpr double least_uncertainty = 1e-3;
constexpr std::uint64_t guard_steps = 64;
constexpr std::ptrdiff_t serial_stretches = 64;
constexpr double progress_seconds = 0.3;

int thread_count(int wanted) {
#ifdef _OPENMP
    return wanted > 0 ? wanted : omp_get_max_threads();
#else
    static_cast<void>(wanted);
    return 1;
#endif
}

class Run {
public:
    Run(const Domain& domain, const Regions& regions, const FlowCase& c, const Progress& progress)
        : domain_(domain),
          case_(c),
          progress_(progress),
          body_(cut_links(domain, regions)),
          wall_(domain.grid, std::move(body_.links), regions.count),
          from_(domain.grid),
          to_(domain.grid),
          relaxation_(relaxation_times(domain.grid, domain.viscosity, domain.sponge)),
          loads_(regions.count),
          before_(regions.count),
          sample_(regions.count),
          threads_(thread_count(c.threads)),
          started_(Clock::now()) {
        if (wall_.stretches() == 0) {
            throw BakeError("flow: the lattice does not meet the body; raise resolution or check the surface's scale");
        }
        run_begin_.assign(domain.grid.rows() + 1, 0);
        for (const SolidRun& run : body_.solid) ++run_begin_[run.row + 1];
        for (std::size_t r = 0; r < domain.grid.rows(); ++r) run_begin_[r + 1] += run_begin_[r];
        fill_stream(domain_.grid, from_, 0);
        fill_stream(domain_.grid, to_, 0);
    }

    FlowSeries solve() {
        FlowSeries series;
        series.plan = domain_.plan;
        series.regions = static_cast<std::uint32_t>(loads_.size());
        series.samples = domain_.samples;
        series.interval = domain_.interval_steps * domain_.plan.time_step;
        const std::size_t values = std::size_t{3} * series.samples * series.regions;
        series.pressure.reserve(values);
        series.friction.reserve(values);
        series.torque.reserve(std::size_t{3} * series.samples);
        std::vector<double> drag;
        drag.reserve(series.samples);

        for (std::uint64_t step = 0; step < domain_.plan.steps; ++step) {
            advance(step);
            if (step > domain_.start_steps) {
                // The exchange on walls along the lattice swings every second step; the trapezoid over an interval has
                // no response at that frequency whatever the interval.
                const double share = 0.5 / domain_.interval_steps;
                for (std::size_t r = 0; r < loads_.size(); ++r) {
                    sample_[r].add(before_[r], share);
                    sample_[r].add(loads_[r], share);
                }
                if ((step - domain_.start_steps) % domain_.interval_steps == 0) store(series, drag);
            }
            std::swap(before_, loads_);
            watch(step);
            report(step);
        }
        finish(series, drag);
        return series;
    }

private:
    double ramp(double step) const {
        const double x = std::min(step / domain_.ramp_steps, 1.0);
        return domain_.stream_speed * x * x * (3 - 2 * x);
    }
    /// A sway across the stream while it starts, gone when it has. On a perfectly symmetric body and lattice the wake
    /// would stay symmetric far into the record, with up to a fifth more or less drag than the wake that sheds.
    double sway(double step) const {
        const double x = std::min(step / domain_.ramp_steps, 1.0);
        return 16 * x * x * (1 - x) * (1 - x) * domain_.stream_speed;
    }

    /// One time step. The stream is speeded up everywhere at once by pushing the fluid as a whole, which is how water
    /// looks from a body that starts to move: pressure stays smooth, where an inlet that speeds up would send waves
    /// through the box.
    void advance(std::uint64_t step) {
        const Grid& grid = domain_.grid;
        const auto now = static_cast<double>(step);
        const double speed = ramp(now + 1);
        Collision collision;
        collision.relaxation = relaxation_.data();
        collision.smagorinsky = static_cast<float>(smagorinsky * smagorinsky);
        const double across = sway(now + 1) - sway(now);
        collision.push[0] = static_cast<float>(speed - ramp(now));
        collision.push[1] = static_cast<float>(sway_y * across);
        collision.push[2] = case_.section ? 0.0f : static_cast<float>(sway_z * across);
        const auto stream = stream_populations(static_cast<float>(speed));
        const auto rows = static_cast<std::ptrdiff_t>(grid.rows());
        const auto stretches = static_cast<std::ptrdiff_t>(wall_.stretches());
        // Few links are quicker done by one thread than by two more meetings of all, above all on a machine with other
        // work (2.4 times at a load of 4 on two cores); rows are handed out in small lots for the same reason. Neither
        // order shows in the result.
#pragma omp parallel num_threads(threads_) if (stretches > serial_stretches)
        {
#pragma omp for schedule(dynamic, 8)
            for (std::ptrdiff_t s = 0; s < stretches; ++s) wall_.gather(from_, static_cast<std::size_t>(s));
#pragma omp for schedule(dynamic, 8)
            for (std::ptrdiff_t s = 0; s < stretches; ++s) wall_.scatter(from_, static_cast<std::size_t>(s));
        }
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 16)
        for (std::ptrdiff_t n = 0; n < rows; ++n) {
            const auto r = static_cast<std::size_t>(n);
            collide_row(grid, from_, to_, r, collision);
            empty_solid(r);
            close_row(grid, to_, r, stream);
        }
        if (step < domain_.ramp_steps) fill_stream(grid, to_, static_cast<float>(speed));
        std::swap(from_, to_);
        wall_.sum(loads_);
        drag_ = 0;
        for (const Load& load : loads_) drag_ += load.force[0];
    }

    /// Cells inside the body are swept along by the bulk's loop; keep them at rest.
    void empty_solid(std::size_t row) {
        for (std::size_t n = run_begin_[row]; n < run_begin_[row + 1]; ++n) {
            const SolidRun& run = body_.solid[n];
            for (int i = 0; i < direction_count; ++i) {
                std::memset(to_.at(i) + domain_.grid.row(row) + run.first, 0, (run.last - run.first) * sizeof(float));
            }
        }
    }

    void store(FlowSeries& series, std::vector<double>& drag) {
        wall_.limit_friction(sample_, domain_.stream_speed, domain_.plan.reynolds);
        Load whole;
        for (Load& load : sample_) {
            whole.add(load, 1);
            const Vec3d pressure = domain_.frame.to_mesh({load.pressure[0], load.pressure[1], load.pressure[2]});
            const Vec3d force = domain_.frame.to_mesh({load.force[0], load.force[1], load.force[2]});
            for (int i = 0; i < 3; ++i) {
                series.pressure.push_back(static_cast<float>(pressure[i] * domain_.force_unit));
                series.friction.push_back(static_cast<float>((force[i] - pressure[i]) * domain_.force_unit));
            }
            load = {};
        }
        const Vec3d torque = domain_.frame.to_mesh({whole.torque[0], whole.torque[1], whole.torque[2]});
        for (int i = 0; i < 3; ++i) {
            series.torque.push_back(static_cast<float>(torque[i] * domain_.force_unit * domain_.plan.cell));
        }
        drag.push_back(whole.force[0]);
    }

    /// Looks at the rest population of every cell now and then: what is wrong in a cell is wrong there, and one of 19
    /// is cheap.
    void watch(std::uint64_t step) {
        bool sound = std::isfinite(drag_);
        if (step % guard_steps == guard_steps - 1) {
            const float* const rest = from_.at(0);
            const Grid& grid = domain_.grid;
            const auto rows = static_cast<std::ptrdiff_t>(grid.rows());
            int bad = 0;
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(+ : bad)
            for (std::ptrdiff_t r = 0; r < rows; ++r) {
                const float* const row = rest + grid.row(static_cast<std::size_t>(r));
                int wrong = 0;
                for (int x = 0; x < grid.nx; ++x) wrong += std::abs(row[x]) < 0.3f ? 0 : 1;
                bad += wrong;
            }
            sound = sound && bad == 0;
        }
        if (sound) return;
        char text[256];
        std::snprintf(text, sizeof text,
                      "flow: the solution diverged at step %llu of %llu (Reynolds number %.4g on %.4g resolution); "
                      "raise resolution or lower speed",
                      static_cast<unsigned long long>(step), static_cast<unsigned long long>(domain_.plan.steps),
                      domain_.plan.reynolds_solved, case_.resolution);
        throw BakeError(text);
    }

    /// The drag coefficient on the projected area, free of blockage.
    double coefficient(double force) const {
        const double area = domain_.plan.projected_area / (domain_.plan.cell * domain_.plan.cell) *
                            (case_.section ? domain_.plan.cell / case_.section_span : 1.0);
        return force / (0.5 * domain_.stream_speed * domain_.stream_speed * area);
    }
    double free_stream(double cd) const {
        const double factor = case_.section ? section_blockage_factor : blockage_factor;
        return 1 / (1 + factor * std::max(cd, 0.0) * domain_.plan.blockage);
    }

    void report(std::uint64_t step) {
        if (!progress_) return;
        const Clock::time_point now = Clock::now();
        const bool last = step + 1 == domain_.plan.steps;
        // Averaged over some twenty steps: the exchange of a single one swings.
        shown_ += 0.05 * (drag_ - shown_);
        if (!last && std::chrono::duration<double>(now - reported_).count() < progress_seconds) return;
        reported_ = now;
        const double cd = coefficient(shown_);
        char note[64];
        std::snprintf(note, sizeof note, step < domain_.ramp_steps ? "starting" : "drag %.2f", cd * free_stream(cd));
        if (!progress_(static_cast<double>(step + 1) / static_cast<double>(domain_.plan.steps), note)) {
            throw FlowCancelled("flow: cancelled");
        }
    }

    void finish(FlowSeries& series, const std::vector<double>& drag) const {
        const double average = mean(drag);
        const auto scale = static_cast<float>(free_stream(coefficient(average)));
        for (float& v : series.pressure) v *= scale;
        for (float& v : series.friction) v *= scale;
        for (float& v : series.torque) v *= scale;
        series.uncertainty = average != 0 ? std::max(least_uncertainty, standard_error(drag) / std::abs(average)) : 1;
        series.seconds = std::chrono::duration<double>(Clock::now() - started_).count();
        const double updates = static_cast<double>(domain_.plan.cells) * static_cast<double>(domain_.plan.steps);
        series.mlups = updates / series.seconds * 1e-6;
    }

    const Domain& domain_;
    const FlowCase& case_;
    const Progress& progress_;
    Body body_;
    Wall wall_;
    Populations from_, to_;
    std::vector<float> relaxation_;
    std::vector<std::size_t> run_begin_;
    std::vector<Load> loads_, before_, sample_;
    double drag_ = 0, shown_ = 0;
    int threads_;
    Clock::time_point started_, reported_;
};

}  // namespace
}  // namespace flow

FlowPlan plan_flow(const Surface& surface, const FlowCase& flow_case) {
    return flow::plan_domain(surface, flow_case).plan;
}

FlowSeries solve_flow(const Surface& surface, const Regions& regions, const FlowCase& flow_case,
                      const Progress& progress) {
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
    if (static_cast<double>(domain.plan.bytes) + series_bytes > static_cast<double>(flow_case.memory_limit)) {
        throw BakeError("flow: the record of " + std::to_string(regions.count) + " regions takes " +
                        std::to_string(static_cast<std::uint64_t>(series_bytes) >> 20) +
                        " MiB more than memory_limit leaves; lower duration");
    }
    try {
        return flow::Run(domain, regions, flow_case, progress).solve();
    } catch (const std::bad_alloc&) {
        throw BakeError("flow: out of memory; " + std::to_string(domain.plan.bytes >> 20) +
                        " MiB are needed: lower resolution");
    }
}

}  // namespace frm::bake
