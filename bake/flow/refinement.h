// Where a block meets the next coarser one. The fine block's ghosts lie on planes of coarse nodes; the coarse block's
// nodes two cells further in lie on fine nodes (the one between is its own still). What passes is density, velocity and
// rate of strain (kernel.h), from which populations of the other cell size are rebuilt: the rescaling of Dupuis &
// Chopard 2003, Phys. Rev. E 67, done on moments; cubic interpolation in the planes as in Lagrava et al. 2012,
// J. Comput. Phys. 231; linear in time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
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

    /// Of one round this block, about.
    static std::uint64_t bytes(const Grid& fine);

    // Rows and tasks are independent, so that threads can share them; no result depends on who does which. `turning` is
    // of the step and the block that is read or written; in a frame that turns, velocities pass as they are in the
    // middle of a step, because a step's force is not the same in both blocks.

    /// What is kept of a row while it collides; the caller brings its velocities to the middle of the step. Reading the
    /// rows once more for it took a fifth of a run. The coarse planes of each step:
    void want_coarse(std::size_t row, Wanted& wanted);
    /// The fine nodes next inside the planes and those around them, of the second step of two; then keep_fine:
    void want_fine(std::size_t row, Wanted& wanted);
    void keep_fine(std::size_t row);

    /// Before the next coarse step: what was new is old.
    void turn() { newest_ = 1 - newest_; }

    std::size_t fill_tasks() const { return fill_tasks_.size(); }
    /// Fills the fine block's ghosts for the time `share` of a coarse step after the older of the two last planes.
    void fill(Populations& fine, float share, const float* push, const Turning& turning, std::size_t task) const;

    std::size_t filter_tasks() const { return filter_tasks_.size(); }
    /// Smooths what was kept of the fine block to what coarse cells can carry.
    void filter(std::size_t task);

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
        // Of the fine nodes: the planes, side by side (of a face across rows already smoothed to one), and what filter
        // hands to restrict_to, coarse nodes along u and fine ones along v.
        std::vector<float> kept, between;

        int between_rows() const { return wraps ? fine_nv : fine_nv - 2; }
        int between_count() const { return (fine_nu - 7) / 2; }
        float* between_row(int field, int n) {
            return between.data() + (static_cast<std::ptrdiff_t>(field) * between_rows() + n) * between_count();
        }
        const float* between_row(int field, int n) const { return const_cast<Face*>(this)->between_row(field, n); }

        std::size_t kept_count() const { return static_cast<std::size_t>(fine_nu - 2); }
        float* kept_row(int plane, int field, int n) {
            const std::size_t row =
                static_cast<std::size_t>(plane * field_count + field) * static_cast<std::size_t>(between_rows()) +
                static_cast<std::size_t>(n);
            return kept.data() + row * kept_count();
        }

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
        /// Coarse row (j, k) holds nodes of the plane that are kept: one of a face across rows, else a row of them.
        bool holds(int j, int k) const;
        /// Which of the planes around the ring fine row (j, k) of a face along rows lies in; -1: in none.
        int plane_of(int j, int k) const;
    };
    struct Task {
        std::size_t face;
        int v;
    };

    void add_face(const Block& fine, const Block& coarse, int axis, bool high);

    Grid fine_, coarse_;
    float fine_relaxation_, coarse_relaxation_, smagorinsky_;
    std::vector<Face> faces_;
    std::vector<Task> fill_tasks_, filter_tasks_, restrict_tasks_;
    int newest_ = 0;
};

}  // namespace frm::bake::flow
