#include "bake/flow/nest.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include "bake/flow/far_field.h"

namespace frm::bake::flow {
namespace {

// Smagorinsky's constant: that of channels. 0.17, of isotropic turbulence, made a sphere's drag at Re 1000 8 % higher.
constexpr float smagorinsky = 0.1f * 0.1f;
constexpr double pi = 3.14159265358979323846;
constexpr double sway_y = 0.05, sway_z = 0.03;  // of the stream's speed
constexpr float soundest = 0.3f;

/// Borders pass velocities as they are in the middle of a step.
void to_middle(const Turning& turning, float y, const Wanted& wanted) {
    if (!turning.on()) return;
    for (std::size_t n = 0; n < wanted.count; ++n) {
        const Wanted::Cells& cells = wanted.cells[n];
        flow::to_middle(turning, {static_cast<float>(cells.begin), y, 1, 0}, cells.end - cells.begin, cells.to[1],
                        cells.to[2]);
    }
}

}  // namespace

Nest::Nest(const Domain& domain, std::vector<SolidRun> solid, Wall& wall, int threads)
    : domain_(domain), wall_(wall), solid_(std::move(solid)), threads_(threads) {
    reach_ = domain.reach / (1 << (domain.levels() - 1));
    for (int l = 0; l < domain.levels(); ++l) {
        const Grid& grid = domain.blocks[static_cast<std::size_t>(l)].grid;
        Level level;
        level.grid = grid;
        level.from = std::make_unique<Populations>(grid);
        level.to = std::make_unique<Populations>(grid);
        const bool outermost = l + 1 == domain.levels();
        level.relaxation = outermost && domain.turning
                               ? still_relaxation_times(grid, domain.relaxation(l), domain.sponge,
                                                        turning(static_cast<std::size_t>(l), 0), reach_)
                               : relaxation_times(grid, domain.relaxation(l), outermost ? domain.sponge : 0);
        level.collision.smagorinsky = smagorinsky;
        level.shares = std::make_unique<Shares>(grid.rows(), threads);
        levels_.push_back(std::move(level));
        if (l > 0) {
            refinements_.emplace_back(
                domain.blocks[static_cast<std::size_t>(l) - 1], domain.blocks[static_cast<std::size_t>(l)],
                static_cast<float>(domain.relaxation(l - 1)), static_cast<float>(domain.relaxation(l)), smagorinsky);
        }
    }
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        levels_[l].collision.relaxation = levels_[l].relaxation.data();
        set_push(levels_[l], std::uint64_t{1} << l);
    }
    const Grid& finest = domain.finest();
    solid_begin_.assign(finest.rows() + 1, 0);
    is_solid_.assign(finest.allocated(), 0);
    for (const SolidRun& run : solid_) {
        ++solid_begin_[run.row + 1];
        std::fill_n(is_solid_.begin() + static_cast<std::ptrdiff_t>(finest.row(run.row) + run.first),
                    run.last - run.first, char{1});
    }
    for (std::size_t r = 0; r < finest.rows(); ++r) solid_begin_[r + 1] += solid_begin_[r];
    fill_far(*levels_.back().from, 0);
    fill_far(*levels_.back().to, 0);
}

/// The ghosts round the outermost block, as they are once the step that ends at `step` has collided.
void Nest::fill_far(Populations& populations, std::uint64_t step) const {
    const Grid& grid = levels_.back().grid;
    if (domain_.turning) {
        fill_still(grid, populations, step == 0 ? Turning{} : turning(levels_.size() - 1, step - steps_at_once()));
    } else {
        fill_stream(grid, populations, stream_populations(stream(step)));
    }
}

double Nest::ramp(double step) const {
    const double x = std::min(step / static_cast<double>(domain_.ramp_steps), 1.0);
    return x * x * (3 - 2 * x);
}

/// A sway across the stream while it starts, gone when it has. On a perfectly symmetric body and lattice the wake would
/// stay symmetric far into the record, with up to a fifth more or less drag than the wake that sheds.
double Nest::sway(double step) const {
    const double x = std::min(step / static_cast<double>(domain_.ramp_steps), 1.0);
    return 16 * x * x * (1 - x) * (1 - x);
}

/// The stream is speeded up everywhere at once by pushing the fluid as a whole, which is how water looks from a body
/// that starts to move: pressure stays smooth, where an inlet that speeds up would send waves through the box.
std::array<float, 3> Nest::stream(std::uint64_t step) const {
    const auto now = static_cast<double>(step);
    const double across = domain_.stream_speed * sway(now);
    return {static_cast<float>(domain_.stream_speed * ramp(now)), static_cast<float>(sway_y * across),
            domain_.finest().periodic ? 0.0f : static_cast<float>(sway_z * across)};
}

void Nest::set_push(Level& level, std::uint64_t steps) const {
    const std::array<float, 3> now = stream(level.step), then = stream(level.step + steps);
    for (std::size_t i = 0; i < 3; ++i) level.collision.push[i] = then[i] - now[i];
    // Along the span of a slab the sway differs, or its wake would stay two-dimensional for a hundred heights.
    level.ripple = domain_.finest().periodic && domain_.finest().nz > 1 ? level.collision.push[1] : 0.0f;
}

/// Of the step of a block that begins at `step`; at rest where the frame does not turn. The spin grows as the stream
/// does.
Turning Nest::turning(std::size_t l, std::uint64_t step) const {
    Turning t;
    if (!domain_.turning) return t;
    const double steps = static_cast<double>(std::uint64_t{1} << l), now = static_cast<double>(step);
    const double before = domain_.spin.z * ramp(now), after = domain_.spin.z * ramp(now + steps);
    const Vec3d axis = (domain_.spin_centre + domain_.node(0, 0, 0, 0)) / steps;
    const std::array<int, 3>& first = domain_.blocks[l].first;
    t.rate = static_cast<float>(0.5 * (before + after) * steps);
    t.change = static_cast<float>((after - before) * steps);
    t.axis_x = static_cast<float>(axis.x - first[0]);
    t.axis_y = static_cast<float>(axis.y - first[1]);
    return t;
}

/// Of the last step of a block.
Turning Nest::turning_before(std::size_t l) const {
    const std::uint64_t steps = std::uint64_t{1} << l, now = levels_[l].step;
    return turning(l, now < steps ? 0 : now - steps);
}

void Nest::advance(const std::function<void(std::uint64_t)>& after_step) {
    after_step_ = &after_step;
#pragma omp parallel num_threads(threads_)
    advance_level(levels_.size() - 1);
}

// Called by every thread of the team; loops without `nowait` end in a meeting of all.
void Nest::advance_level(std::size_t l) {
    Level& level = levels_[l];
    const bool outermost = l + 1 == levels_.size();
    if (l == 0) walls();
    bulk(l);

    const Turning turns = turning(l, level.step);
    const auto fills = static_cast<std::ptrdiff_t>(outermost ? 0 : refinements_[l].fill_tasks());
#pragma omp for schedule(static)
    for (std::ptrdiff_t n = 0; n < fills; ++n) {
        refinements_[l].fill(*level.to, level.second ? 1.0f : 0.5f, level.collision.push, turns,
                             static_cast<std::size_t>(n));
    }
#pragma omp single
    {
        level.shares->reset();
        level.step += std::uint64_t{1} << l;
        level.second = !level.second;
        if (outermost && level.step <= domain_.ramp_steps + 2 * steps_at_once()) {
            fill_far(*level.to, level.step);
        }
        std::swap(level.from, level.to);
        // restrict_to needs the push of the step that this was, so the coarser blocks wait with theirs.
        if (l == 0) set_push(level, 1);
        if (l == 0) (*after_step_)(level.step);
    }
    if (l == 0) return;
    advance_level(l - 1);
    advance_level(l - 1);
    Refinement& border = refinements_[l - 1];
    const auto filters = static_cast<std::ptrdiff_t>(border.filter_tasks());
    const auto writes = static_cast<std::ptrdiff_t>(border.restrict_tasks());
#pragma omp for schedule(static)
    for (std::ptrdiff_t n = 0; n < filters; ++n) border.filter(static_cast<std::size_t>(n));
#pragma omp for schedule(static)
    for (std::ptrdiff_t n = 0; n < writes; ++n) {
        border.restrict_to(*level.from, level.collision.push, turns, static_cast<std::size_t>(n));
    }
#pragma omp single
    {
        border.turn();
        set_push(level, std::uint64_t{1} << l);
    }
}

void Nest::walls() {
    const auto stretches = static_cast<std::ptrdiff_t>(wall_.stretches());
    Populations& from = *levels_.front().from;
    const auto motion = domain_.turning ? 0.0f : static_cast<float>(ramp(static_cast<double>(levels_.front().step)));
#pragma omp for schedule(static)
    for (std::ptrdiff_t s = 0; s < stretches; ++s) wall_.gather(from, motion, static_cast<std::size_t>(s));
#pragma omp for schedule(static)
    for (std::ptrdiff_t s = 0; s < stretches; ++s) wall_.scatter(from, static_cast<std::size_t>(s));
}

void Nest::bulk(std::size_t l) {
    Level& level = levels_[l];
    const Grid& grid = level.grid;
    const bool outermost = l + 1 == levels_.size(), turns_frame = domain_.turning;
    const Turning turns = turning(l, level.step);
    const auto far = stream_populations(stream(level.step + (std::uint64_t{1} << l)));
    level.shares->each([&](std::size_t r) {
        Collision collision = level.collision;
        Wanted wanted;
        if (l > 0) refinements_[l - 1].want_coarse(r, wanted);
        const bool ends_pair = !outermost && level.second;
        if (ends_pair) refinements_[l].want_fine(r, wanted);
        if (turns_frame) {
            if (outermost) collision.relaxation += r * grid.pitch();
            collide_row(grid, *level.from, *level.to, r, collision, wanted, turns);
        } else {
            if (level.ripple != 0) {
                const double place = 2 * pi * grid.row_z(r) / grid.nz;
                collision.push[1] += level.ripple * static_cast<float>(std::cos(place) + std::cos(2 * place + 1));
            }
            collide_row(grid, *level.from, *level.to, r, collision, wanted);
        }
        to_middle(turns, static_cast<float>(grid.row_y(r)), wanted);
        if (ends_pair) refinements_[l].keep_fine(r);
        if (l == 0) empty_solid(r);
        if (!outermost) return;
        if (turns_frame) {
            close_row_still(grid, *level.to, r, turns, reach_);
        } else {
            close_row(grid, *level.to, r, far, domain_.stream_speed > 0);
        }
    });
#pragma omp barrier
}

/// Cells inside the body are swept along by the bulk's loop; keep them at rest.
void Nest::empty_solid(std::size_t row) {
    Level& level = levels_.front();
    for (std::size_t n = solid_begin_[row]; n < solid_begin_[row + 1]; ++n) {
        const SolidRun& run = solid_[n];
        for (int i = 0; i < direction_count; ++i) {
            std::memset(level.to->at(i) + level.grid.row(row) + run.first, 0, (run.last - run.first) * sizeof(float));
        }
    }
}

/// Inside the next finer block only its own nodes hold the flow. Returns the block that was read.
std::size_t Nest::read_node(std::size_t l, const std::array<int, 3>& at, const Fields& out) const {
    if (l > 0) {
        std::array<int, 3> finer{};
        bool inside = true;
        for (int axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<std::size_t>(axis);
            const Grid& grid = levels_[l - 1].grid;
            const bool whole = axis == 2 && grid.periodic && grid.nz == 1;
            finer[a] = whole ? 0 : 2 * (at[a] + domain_.blocks[l].first[a]) - domain_.blocks[l - 1].first[a];
            inside = inside && finer[a] >= 0 && finer[a] < grid.size(axis);
        }
        if (inside) return read_node(l - 1, finer, out);
    }
    // The copy not in use is that of the step before, walls included: what this step pulled from.
    observe(levels_[l].grid, *levels_[l].to, at[0], at[1], at[2], 1,
            static_cast<float>(domain_.relaxation(static_cast<int>(l))), smagorinsky, out);
    if (domain_.turning) {
        const Line here{static_cast<float>(at[0]), static_cast<float>(at[1]), 0, 0};
        flow::to_middle(turning_before(l), here, 1, out[1], out[2]);
    }
    return l;
}

bool Nest::sample(const Vec3d& point, std::array<float, field_count>& fields) const {
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        const Level& level = levels_[l];
        const Grid& grid = level.grid;
        const double cell = static_cast<double>(std::uint64_t{1} << l);
        int low[3];
        double part[3];
        bool inside = true;
        for (int axis = 0; axis < 3; ++axis) {
            const int size = grid.size(axis);
            double at = point[axis] / cell - domain_.blocks[l].first[static_cast<std::size_t>(axis)];
            if (axis == 2 && grid.periodic) at -= size * std::floor(at / size);
            low[axis] = static_cast<int>(std::floor(at));
            part[axis] = at - low[axis];
            if (axis == 2 && grid.periodic) continue;
            if (low[axis] == size - 1 && part[axis] == 0) low[axis] = size - 2, part[axis] = 1;
            inside = inside && low[axis] >= 0 && low[axis] + 1 < size;
        }
        if (!inside) continue;
        std::array<float, field_count> one{};
        Fields out{};
        for (std::size_t f = 0; f < field_count; ++f) out[f] = &one[f];
        double sum[field_count] = {}, weights = 0;
        for (int corner = 0; corner < 8; ++corner) {
            double share = 1;
            int at[3];
            for (int axis = 0; axis < 3; ++axis) {
                const int step = (corner >> axis) & 1;
                share *= step == 1 ? part[axis] : 1 - part[axis];
                at[axis] = low[axis] + step;
            }
            if (share == 0) continue;
            at[2] = grid.wrap(at[2]);
            if (l == 0 && is_solid_[grid.index(at[0], at[1], at[2])] != 0) continue;
            const std::size_t read = read_node(l, {at[0], at[1], at[2]}, out);
            const double finer = cell / static_cast<double>(std::uint64_t{1} << read);
            for (std::size_t f = 0; f < field_count; ++f) {
                sum[f] += share * static_cast<double>(one[f]) * (f < 4 ? 1.0 : finer);
            }
            weights += share;
        }
        if (weights < 0.5) return false;
        for (std::size_t f = 0; f < field_count; ++f) {
            fields[f] = static_cast<float>(sum[f] / weights / (f < 4 ? 1.0 : cell));
        }
        return true;
    }
    return false;
}

void Nest::set(const Source& source) {
    for (std::size_t l = 0; l < levels_.size(); ++l) {
        Level& level = levels_[l];
        const Grid& grid = level.grid;
        level.step = domain_.first_step;
        set_push(level, std::uint64_t{1} << l);
        const auto relaxation = static_cast<float>(domain_.relaxation(static_cast<int>(l)));
        const int border = l + 1 == levels_.size() ? 0 : 1, border_z = grid.periodic ? 0 : border;
        const float none[3] = {};
        const Turning turns = turning_before(l);
#pragma omp parallel for num_threads(threads_) schedule(dynamic, 1)
        for (int k = -border_z; k < grid.nz + border_z; ++k) {
            std::array<float, field_count> fields{};
            std::array<float, direction_count> f{};
            ConstFields in{};
            for (std::size_t n = 0; n < field_count; ++n) in[n] = &fields[n];
            std::array<float*, direction_count> out{};
            for (std::size_t n = 0; n < direction_count; ++n) out[n] = &f[n];
            for (int j = -border; j < grid.ny + border; ++j) {
                for (int i = -border; i < grid.nx + border; ++i) {
                    const std::size_t cell = grid.index(i, j, k);
                    if (l == 0 && i >= 0 && j >= 0 && k >= 0 && i < grid.nx && j < grid.ny && k < grid.nz &&
                        is_solid_[cell] != 0) {
                        continue;
                    }
                    source(domain_.node(static_cast<int>(l), i, j, k), fields);
                    const Line here{static_cast<float>(i), static_cast<float>(j), 0, 0};
                    if (turns.on()) from_middle(turns, here, 1, &fields[1], &fields[2]);
                    rebuild(in, 1, static_cast<float>(std::uint64_t{1} << l), relaxation, smagorinsky, none, out);
                    for (int d = 0; d < direction_count; ++d) {
                        level.from->at(d)[cell] = level.to->at(d)[cell] = f[static_cast<std::size_t>(d)];
                    }
                }
            }
        }
        if (l + 1 == levels_.size()) {
            const auto far = stream_populations(stream(level.step));
            for (Populations* p : {level.from.get(), level.to.get()}) {
                fill_far(*p, level.step);
                for (std::size_t r = 0; r < grid.rows(); ++r) {
                    if (domain_.turning) {
                        close_row_still(grid, *p, r, turns, reach_);
                    } else {
                        close_row(grid, *p, r, far, domain_.stream_speed > 0);
                    }
                }
            }
        }
    }
    for (std::size_t l = 1; l < levels_.size(); ++l) {
        const Level& level = levels_[l];
        const Turning turns = turning_before(l);
        for (std::size_t r = 0; r < level.grid.rows(); ++r) {
            Wanted wanted;
            refinements_[l - 1].want_coarse(r, wanted);
            for (std::size_t n = 0; n < wanted.count; ++n) {
                const Wanted::Cells& cells = wanted.cells[n];
                flow::observe(level.grid, *level.to, static_cast<int>(cells.begin), level.grid.row_y(r),
                              level.grid.row_z(r), cells.end - cells.begin,
                              static_cast<float>(domain_.relaxation(static_cast<int>(l))), smagorinsky, cells.to);
            }
            to_middle(turns, static_cast<float>(level.grid.row_y(r)), wanted);
        }
        refinements_[l - 1].turn();
    }
}

std::uint64_t Nest::unsound() const {
    std::uint64_t bad = 0;
    for (const Level& level : levels_) {
        const float* const rest = level.from->at(0);
        const Grid& grid = level.grid;
        const auto rows = static_cast<std::ptrdiff_t>(grid.rows());
#pragma omp parallel for num_threads(threads_) schedule(static) reduction(+ : bad)
        for (std::ptrdiff_t r = 0; r < rows; ++r) {
            const float* const row = rest + grid.row(static_cast<std::size_t>(r));
            std::uint64_t wrong = 0;
            for (int x = 0; x < grid.nx; ++x) wrong += std::abs(row[x]) < soundest ? 0 : 1;
            bad += wrong;
        }
    }
    return bad;
}

}  // namespace frm::bake::flow
