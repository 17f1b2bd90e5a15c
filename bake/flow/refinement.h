// Where a block meets the next coarser one. The fine block's ghosts lie on planes of coarse nodes; the coarse block's
// nodes two cells further in lie on fine nodes (the one between is its own still). What passes is density, velocity and
// rate of strain (kernel.h), from which populations of the other cell size are rebuilt: the rescaling of Dupuis &
// Chopard 2003, Phys. Rev. E 67, done on moments; cubic interpolation in the planes as in Lagrava et al. 2012,
// J. Comput. Phys. 231; linear in time.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "bake/flow/domain.h"
#include "bake/flow/kernel.h"
#include "bake/flow/lattice.h"

namespace frm::bake::flow {

class Refinement {
public:
    /// Between two neighbours of a domain's blocks. Relaxation times are those of the molecular viscosity.
    Refinement(const Block& fine, const Block& coarse, float fine_relaxation, float coarse_relaxation,
               float smagorinsky);

    // Each of the following is a number of independent tasks, so that threads can share them; no result depends on who
    // does which. `turning` is of the step and the block that is read or written; in a frame that turns, velocities
    // pass as they are in the middle of a step, because a step's force is not the same in both blocks.

    /// Before observe: what was new is old.
    void turn() { newest_ = 1 - newest_; }
    std::size_t observe_tasks() const { return observe_tasks_.size(); }
    /// Reads the coarse planes of the step that pulls from `coarse`.
    void observe(const Populations& coarse, const Turning& turning, std::size_t task);

    std::size_t fill_tasks() const { return fill_tasks_.size(); }
    /// Fills the fine block's ghosts for the time `share` of a coarse step after the older of the two last planes.
    void fill(Populations& fine, float share, const float* push, const Turning& turning, std::size_t task) const;

    std::size_t filter_tasks() const { return filter_tasks_.size(); }
    /// Reads the fine step that pulls from `fine` next inside the planes, smoothed to what coarse cells can carry.
    void filter(const Populations& fine, const Turning& turning, std::size_t task);

    std::size_t restrict_tasks() const { return restrict_tasks_.size(); }
    /// After all of filter: writes the coarse nodes next inside the planes.
    void restrict_to(Populations& coarse, const float* push, const Turning& turning, std::size_t task) const;

private:
    struct Range {
        std::size_t begin, end;
    };
    /// One of the six planes (four for a section) and how its nodes are counted: u along rows, v across them.
    struct Face {
        int axis = 0, u = 1, v = 2;
        bool high = false;
        bool wraps = false;            // v is the periodic axis
        int coarse = 0, fine = 0;      // the plane, as index of either block
        int ring = 0, fine_ring = 0;   // the coarse nodes written by restriction
        int u_first = 0, v_first = 0;  // first coarse node kept of the plane
        int nu = 0, nv = 0;            // coarse nodes kept, a node more on each side than the fine block needs
        int fine_nu = 0, fine_nv = 0;  // fine nodes of the plane, its borders included
        int v_scale = 2;               // fine nodes a coarse one along v (1: two dimensions)
        std::array<int, 5> inward{};   // directions that enter the fine block
        std::array<std::vector<float>, 2> fields;
        std::vector<float> between;  // what filter hands to restrict_to: coarse nodes along u, fine ones along v

        int between_rows() const { return wraps ? fine_nv : fine_nv - 2; }
        int between_count() const { return (fine_nu - 7) / 2; }
        float* between_row(int field, int n) {
            return between.data() + (static_cast<std::ptrdiff_t>(field) * between_rows() + n) * between_count();
        }
        const float* between_row(int field, int n) const { return const_cast<Face*>(this)->between_row(field, n); }

        float* row(int time, int field, int n) {
            return fields[static_cast<std::size_t>(time)].data() + (static_cast<std::ptrdiff_t>(field) * nv + n) * nu;
        }
        const float* row(int time, int field, int n) const { return const_cast<Face*>(this)->row(time, field, n); }
        /// Where two faces meet, both know the nodes, but not to the last bit: those that the face of the lower axis writes
        /// are left to it. Nodes of a row of `count` to write for a direction.
        Range mine(int entering, std::size_t count, bool first_row, bool last_row) const;
        std::array<int, 3> at(int plane, int along_u, int along_v) const;
        /// Nodes of a row from `p` on, `step` nodes apart along u.
        Line line_of(const std::array<int, 3>& p) const;
    };
    struct Task {
        std::size_t face;
        int v;
    };

    void add_face(const Block& fine, const Block& coarse, int axis, bool high);

    Grid fine_, coarse_;
    float fine_relaxation_, coarse_relaxation_, smagorinsky_;
    std::vector<Face> faces_;
    std::vector<Task> observe_tasks_, fill_tasks_, filter_tasks_, restrict_tasks_;
    int newest_ = 0;
};

}  // namespace frm::bake::flow
