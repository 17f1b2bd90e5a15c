// The wall: what comes back along the cut links, and the force of the water that follows from it, by region.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "bake/flow/lattice.h"
#include "bake/flow/links.h"

namespace frm::bake::flow {

/// In lattice units, in the stream's frame.
struct Load {
    double force[3] = {}, pressure[3] = {}, torque[3] = {};

    void add(const Load& o, double share) {
        for (int i = 0; i < 3; ++i) {
            force[i] += share * o.force[i];
            pressure[i] += share * o.pressure[i];
            torque[i] += share * o.torque[i];
        }
    }
};

class Wall {
public:
    /// `apart`: floats from one direction's populations to the next, as Populations::apart().
    Wall(const std::vector<Link>& links, std::uint32_t regions, std::ptrdiff_t apart);

    /// Work is shared out by stretches of links of one region, of a length that does not depend on the threads. Sums
    /// over a stretch go in one order and the stretches are added in theirs, so the bits are the same.
    std::size_t stretches() const { return stretches_.size(); }

    /// Reads the populations and keeps what each link of a stretch sends back, and its load. `motion`: the share of its
    /// speed that a moving wall has reached.
    void gather(const Populations& from, float motion, std::size_t stretch);
    /// Writes what comes back where the cells will pull it from. After all of gather: both sides of a thin wall share
    /// cells.
    void scatter(Populations& from, std::size_t stretch) const;
    /// Loads of the regions after gather.
    void sum(std::vector<Load>& regions) const;
    /// Moves friction into pressure where there is more of it than a laminar boundary layer can carry (three times the
    /// mean of a flat plate, Blasius, and two and a half times that of a sphere in creeping flow). Where cells are
    /// coarser than the layer, or than the body, the exchange along a wall is momentum carried past it and grows with
    /// the square of the speed; a map scales friction with the speed itself and would lose it: half the drag of a shaft
    /// one cell thick.
    void limit_friction(std::vector<Load>& regions, double speed, double reynolds) const;

private:
    struct Stretch {
        std::size_t first = 0, last = 0;
        std::uint32_t region = 0;
        Load load;
    };
    /// What a link reads and writes, in floats from the populations at rest.
    struct Places {
        std::ptrdiff_t out, in, far, into;
    };
    struct Weights {
        float out, in, far, wall;
    };
    /// What a unit of exchanged momentum adds to the load: force, pressure, torque.
    static constexpr std::size_t parts = 9;

    std::vector<Places> places_;
    std::vector<Weights> weights_;
    std::array<std::vector<float>, parts> share_;  // [part][link]
    std::vector<float> back_, exchange_;
    std::vector<Stretch> stretches_;
    std::vector<double> area_;  // of the regions, in cells squared
};

}  // namespace frm::bake::flow
