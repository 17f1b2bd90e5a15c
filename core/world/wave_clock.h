// When the water is stepped: in which ticks, how many times, and by how much time.
#pragma once

#include <cstdint>

#include "core/math/hash.h"

namespace frm {

/// The water's part of a tick.
struct WaveTime {
    float time = 0;           ///< s, of all its steps; where it waits, how long it has waited after it
    std::uint32_t steps = 0;  ///< 0: it waits
    bool waited = false;      ///< the tick begins, or may begin, between two steps
    float behind = 0;         ///< s: how long ago the water is as its field is, after the tick
    float step = 0;           ///< s, of each step, or of the one that it waits for
    float equal = 0;          ///< s; 0: see WaveClock
};

/// As long as ticks are of one length, so are steps: as many as fit into a tick, or one for several ticks. Once ticks
/// differ, all steps have one length, ticks take the whole ones that fit, and what is left waits. A leapfrog step keeps the
/// energy of the waves as measured by its own length; steps of two lengths in turn pump the shortest waves, e-fold in 0.3 s
/// at 60 and 30 Hz in turn (parametric resonance; docs/stability.md).
class WaveClock {
public:
    struct Limits {
        float stable;   ///< s: the longest step
        float wait;     ///< s, at most `stable`: the longest step that is waited for
        bool may_wait;  ///< in ticks of one length
    };
    static constexpr std::uint32_t max_substeps = 1024;

    /// Throws Error (FRM_ERROR_LIMIT) if a tick of dt would take more than max_substeps steps.
    WaveTime plan(float dt, const Limits& limits) const;
    /// A tick of dt went by as planned.
    void advance(float dt, const WaveTime& done);
    /// Other water, or at rest: what was before does not count.
    void restart() { *this = {}; }

    float behind() const { return behind_; }        ///< s: how long ago the water was as its field is
    float last_step() const { return last_step_; }  ///< s; 0 where no tick waits
    void hash(StateHash& hash) const;

private:
    static float step_for(float dt, const Limits& limits);
    float equal_for(float dt, const Limits& limits) const;

    float behind_ = 0, last_step_ = 0;
    float dt_ = 0;     ///< of the tick before; 0: there was none
    float equal_ = 0;  ///< of all steps; 0: ticks have been of one length
};

}  // namespace frm
