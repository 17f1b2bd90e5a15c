// How a body of a scene moves: at rest, steadily, along keyframes, or with a device.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "cli/json_reader.h"
#include "frm.h"

namespace frm::cli {

struct Keyframe {
    double time = 0;
    std::array<double, 6> value{};  ///< position (m), then rotation about x, y, z (radians, applied in that order)
};

class Motion {
public:
    /// From a scene's "motion" (docs/scene.md). Throws Failure naming what is wrong.
    explicit Motion(const JsonReader& motion);

    /// Not at(), but what the device of this name says.
    const std::string& device() const { return device_; }
    void at(double time, frm_pose& pose, frm_twist& twist) const;

private:
    std::array<double, 6> value(double time) const;
    std::array<double, 6> rate(double time) const;

    std::vector<Keyframe> keys_;
    std::array<double, 6> velocity_{};  ///< of a steady motion: linear, and of the three angles
    bool repeat_ = false;
    std::string device_;
};

}  // namespace frm::cli
