// The nested blocks in time: a step of one block, then two of the next finer one inside it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "bake/flow/collision.h"
#include "bake/flow/domain.h"
#include "bake/flow/forces.h"
#include "bake/flow/kernel.h"
#include "bake/flow/lattice.h"
#include "bake/flow/links.h"
#include "bake/flow/refinement.h"
#include "bake/flow/threads.h"

namespace frm::bake::flow {

class Nest {
public:
    /// `solid`: cells of the finest block inside the body. `wall` belongs to the caller.
    Nest(const Domain& domain, std::vector<SolidRun> solid, Wall& wall, int threads);

    /// One step of the coarsest block and all that the finer ones take in it. `after_step` is called after each of the
    /// finest, by one thread, with the step's number; it must not throw.
    void advance(const std::function<void(std::uint64_t)>& after_step);

    /// Steps of the finest block so far.
    std::uint64_t step() const { return levels_.front().step; }
    std::uint64_t steps_at_once() const { return std::uint64_t{1} << (levels_.size() - 1); }

    /// How many cells hold what no flow can be. One of 19 populations is looked at: what is wrong in a cell is wrong
    /// there.
    std::uint64_t unsound() const;

    /// Fields (kernel.h) of the last step at a point in finest cells from the lattice's origin, of the finest block that
    /// has it, linear between nodes; strain per step of the finest block. False outside all blocks and inside the body.
    /// Velocity is that in the body's frame.
    bool sample(const Vec3d& point, std::array<float, field_count>& fields) const;

    /// Sets every cell to what `source` says of its place (as `sample`); the clock stands at Domain::first_step then.
    using Source = std::function<void(const Vec3d& point, std::array<float, field_count>& fields)>;
    void set(const Source& source);

private:
    struct Level {
        Grid grid;
        std::unique_ptr<Populations> from, to;
        std::vector<float> relaxation;  // for each cell of a row
        Collision collision;
        std::unique_ptr<Shares> shares;
        float ripple = 0;        // what the push across differs by along a slab's span
        std::uint64_t step = 0;  // in finest steps
        bool second = false;     // of two in the coarser block's step
    };

    std::size_t read_node(std::size_t level, const std::array<int, 3>& at, const Fields& fields) const;
    void advance_level(std::size_t level);
    void walls();
    void bulk(std::size_t level);
    void empty_solid(std::size_t row);
    double ramp(double step) const;
    double sway(double step) const;
    std::array<float, 3> stream(std::uint64_t step) const;
    void set_push(Level& level, std::uint64_t steps) const;
    Turning turning(std::size_t level, std::uint64_t step) const;
    Turning turning_before(std::size_t level) const;
    void fill_far(Populations& populations, std::uint64_t step) const;

    const Domain& domain_;
    Wall& wall_;
    std::vector<Level> levels_;            // finest first
    std::vector<Refinement> refinements_;  // [l] between levels l and l + 1
    std::vector<SolidRun> solid_;
    std::vector<std::size_t> solid_begin_;  // of each row
    std::vector<char> is_solid_;            // of each cell of the finest block
    const std::function<void(std::uint64_t)>* after_step_ = nullptr;
    double reach_ = 0;  // to the water that is held at rest in the turning frame, outermost cells
    int threads_;
};

}  // namespace frm::bake::flow
