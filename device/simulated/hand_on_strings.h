// A grip that eight strings pull and a hand holds: what the simulated SPIDAR-G measures and moves.
#pragma once

#include "device/spidar_g/amplifier.h"

namespace frm::simulated {

using spidar_g::Configuration;
using spidar_g::Counters;
using spidar_g::GripPose;
using spidar_g::GripTwist;
using spidar_g::Tensions;

/// What can be made to go wrong with the mechanics; -1 for no string.
struct StringFaults {
    int stuck = -1;              ///< its encoder stands still
    int slack = -1;              ///< `slack_length` more string is out than the way is long
    int broken = -1;             ///< it pulls nothing, and its motor winds it up
    double slack_length = 0.02;  ///< m
};

class HandOnStrings {
public:
    explicit HandOnStrings(const Configuration& configuration);

    /// Lets `dt` seconds pass with these motor tensions, in steps of at most 0.1 ms (semi-implicit Euler).
    void advance(double dt, const Tensions& tensions);
    /// The whole encoder counts, from 0 at the beginning.
    Counters counts() const;

    const GripPose& pose() const { return pose_; }
    const GripTwist& twist() const { return twist_; }
    /// Puts the grip somewhere, at rest; the hand then draws it to where it leads.
    void place(const GripPose& pose);

    StringFaults faults;

private:
    void step(double dt, const Tensions& tensions);

    Configuration configuration_;
    GripPose pose_;
    GripTwist twist_;
    spidar_g::StringRows rows_;
    spidar_g::Lengths first_{};  ///< at the centre
    spidar_g::Lengths slack_{};
    spidar_g::Lengths out_{};       ///< of each string, as its motor has it
    double cosine_ = 1, sine_ = 0;  ///< of the phase of what leads the hand
};

}  // namespace frm::simulated
