// What one body gives the waves and what it has paid for: waves never have more energy than the work that was done on the
// water.
#pragma once

#include <memory_resource>
#include <vector>

#include "core/body/volume_elements.h"
#include "core/water/footprint.h"

namespace frm {

/// Where the centre of a body lies over the water, and how deep, in the map's lengths, along `up`, the world's z axis in the
/// body's frame.
struct Immersion {
    GridPlacement at;
    Vec3f up;
    float depth = 0;
};

/// The water's pressure on a body is hydrostatic at every depth, but what the body displaces is laid on the water spread the
/// wider the deeper it lies. The body pays for the heights where it is, the water gets what it displaces where that is spread
/// to: by what the two differ, waves have more (or less) than the body was made to pay.
class WaveAccount {
public:
    /// `levels` are the footprint's.
    WaveAccount(const VolumeElements& elements, int levels, std::pmr::memory_resource* memory);

    /// J: a share of the work of the body's drag, less what its pushes and the spread of its displacement gave the waves. What
    /// it lacks, the water around the body gives back (share_of_push).
    double credit = 0;
    /// J that drag has done since the water was last stepped.
    double drag_work = 0;

    /// In a tick whose thickness is laid and not yet in the water: takes what the water will have of its change beyond what
    /// the body pays. `per_length`: cells in the map's length; `weight`: the fluid's, N/m^3; `half_step` as in
    /// work_of_change; `scratch` is as large as the field's heights.
    void charge(const Footprint& footprint, const Field& water, const Immersion& now, float per_length, float weight,
                float dt, float half_step, float* scratch);
    /// A tick whose thickness is that of the one before.
    void stay() { ticks_ = 0; }
    /// The next change is not counted: of a body that does not lay its volume.
    void forget() { known_ = false; }
    /// The water is another.
    void clear() { credit = drag_work = surplus_ = 0, ticks_ = 0; }

private:
    struct Points {
        float x[4 * kernel_lanes], y[4 * kernel_lanes], z[4 * kernel_lanes];
    };
    double felt(const HeightGrid& water, const Immersion& body, float per_length) const;
    float moved(const Immersion& now, float per_length) const;

    std::pmr::vector<OnLines<ElementBlock>> elements_;
    std::pmr::vector<OnLines<Points>> points_;
    float radius_ = 0;  ///< of all points, the map's lengths
    Immersion before_;
    bool known_ = false;  ///< before_ is of the thickness before
    // Of the last tick whose surplus was worked out: that, J; how far the body moved in it, cells; its length, s; and for how
    // many ticks more it will do.
    double surplus_ = 0;
    float moved_ = 0, dt_ = 0;
    std::uint32_t ticks_ = 0;
};

}  // namespace frm
