#include "device/spidar_g/velocity_filter.h"

namespace frm::spidar_g {

GripTwist VelocityFilter::add(const GripPose& pose, double dt) {
    const GripPose before = last_;
    last_ = pose;
    if (first_) {
        first_ = false;
        return {};
    }
    newest_ = (newest_ + 1) % most;
    ring_[newest_] = {pose.position - before.position, rotation_between(before.rotation, pose.rotation), dt};
    if (steps_ < window_ - 1) ++steps_;
    // The slope of a least-squares line through n points is the mean of their n - 1 differences with the weights
    // k (n - k); over the mean of the times with the same weights it is exact also where cycles are uneven.
    Vec3d linear, angular;
    double time = 0;
    const std::uint32_t n = steps_ + 1;
    for (std::uint32_t k = 1; k <= steps_; ++k) {
        const Step& step = ring_[(newest_ + most + 1 - k) % most];
        const double weight = static_cast<double>(k) * (n - k);
        linear += step.linear * weight;
        angular += step.angular * weight;
        time += step.dt * weight;
    }
    if (!(time > 0)) return {};
    return {linear / time, angular / time};
}

}  // namespace frm::spidar_g
