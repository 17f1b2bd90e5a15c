// A SPIDAR-G behind any transport: counts to lengths to a pose and its twist, a wrench to tensions to DAC values; what
// can go wrong is watched. Frames and units are the device's own (docs/devices.md): y up, the origin at its centre.
//
// Not yet run on hardware.
#pragma once

#include <memory>

#include "device/spidar_g/amplifier.h"
#include "device/spidar_g/configuration.h"
#include "device/spidar_g/kinematics.h"
#include "device/spidar_g/tensions.h"
#include "device/spidar_g/transport.h"
#include "device/spidar_g/velocity_filter.h"
#include "frm.h"

namespace frm::spidar_g {

struct GripState {
    GripPose pose;
    GripTwist twist;      ///< of (velocity_window - 1) / 2 cycles ago
    GripWrench achieved;  ///< of the tensions that the DAC was told, after limits and rounding; zero without a pose
    std::uint32_t buttons = 0;
    std::uint32_t faults = FRM_DEVICE_FAULT_UNCALIBRATED;  ///< frm_device_fault
    std::uint64_t time_ns = 0;
};

class SpidarG {
public:
    SpidarG(Configuration configuration, std::unique_ptr<Transport> transport);

    const Configuration& configuration() const { return configuration_; }
    const Transport& transport() const { return *transport_; }

    /// Clears the pipes, sends what a session begins with, and makes one exchange without tension. False if there is no
    /// answer.
    bool begin();
    /// The rotary switch, after begin().
    std::uint32_t rotary_id() const { return Amplifier::rotary_id(reading_); }

    /// One cycle: displays the wrench if all is well, the least tensions if not. Bounded by the transport's timeout. Ramps
    /// and deadlines are the safety layer's.
    GripState exchange(const GripWrench& wrench);
    /// The grip is at the centre, unturned. Clears every latched fault. False if there is no answer.
    bool calibrate();
    /// One cycle with the least tensions. The counters are followed.
    void stop();

    /// The reply of the last cycle as it came, with counters, A/D and switches; empty if there was none.
    const Packet& last_reply() const { return reply_; }

private:
    bool displays() const { return calibrated_ && state_.faults == 0; }
    Tensions chosen(const GripWrench& wrench);
    Digits digits_for(const Tensions& tensions, Tensions& told) const;
    bool cycle(const Tensions& tensions, GripWrench* achieved);
    void took(std::uint64_t now);
    std::uint32_t name_fault(const PoseFit& fit, const Lengths& lengths, double worst);
    void look_for_faults(const PoseFit& fit, const Lengths& lengths, double dt);

    Configuration configuration_;
    std::unique_ptr<Transport> transport_;
    std::unique_ptr<Amplifier> amplifier_;
    CounterExtension counters_;
    TensionSolver solver_;
    VelocityFilter filter_;

    StringRows rows_;                        ///< of the pose that the tensions are for
    Lengths reference_{};                    ///< at the centre
    Lengths lengths_{};                      ///< of the last cycle
    Lengths well_{};                         ///< when they last fitted a pose
    std::array<int, string_count> still_{};  ///< cycles since a count last changed
    Request request_;
    Packet reply_;
    Reading reading_;
    GripState state_;
    std::uint32_t broken_ = 0;  ///< bit i: string i has no motor that should pull
    std::uint64_t last_ns_ = 0;
    bool calibrated_ = false;
};

}  // namespace frm::spidar_g
