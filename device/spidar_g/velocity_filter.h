// The grip's twist from its last poses: the slope of the line that fits them best.
#pragma once

#include <array>
#include <cstdint>

#include "device/spidar_g/geometry.h"

namespace frm::spidar_g {

/// One encoder count a cycle is 17 mm/s at 1 kHz, so differences of two poses are no velocity. A least-squares line
/// over n poses has the velocity of (n - 1) / 2 cycles ago, and sqrt(12 / n^3) of the noise of a difference.
class VelocityFilter {
public:
    static constexpr std::uint32_t most = 64;

    /// `window` poses, 2 to `most`.
    explicit VelocityFilter(std::uint32_t window) : window_(window) {}

    void reset() {
        steps_ = 0;
        first_ = true;
    }
    /// The twist with this pose as the newest, `dt` seconds after the one before it. Zero for the first.
    GripTwist add(const GripPose& pose, double dt);
    /// How far its answer is behind, in cycles.
    double delay_cycles() const { return (window_ - 1) / 2.0; }

private:
    struct Step {
        Vec3d linear, angular;
        double dt;
    };

    std::uint32_t window_;
    std::uint32_t steps_ = 0, newest_ = 0;
    bool first_ = true;
    GripPose last_;
    std::array<Step, most> ring_{};
};

}  // namespace frm::spidar_g
