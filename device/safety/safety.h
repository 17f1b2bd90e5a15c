// The layer between host and device: what of a commanded wrench is sent, and when nothing is. One file a rule; here they
// are put in order. It is told every command and every state and looks at nothing else, so that the same exchanges give
// the same bits.
#pragma once

#include "device/safety/fault_latch.h"
#include "device/safety/limits.h"
#include "device/safety/passivity.h"
#include "device/safety/state_checks.h"

namespace frm::device {

frm_device_safety_def default_safety();
/// Throws Error (FRM_ERROR_ARGUMENT) naming the field.
void require_safety(const frm_device_safety_def& def);

class Safety {
public:
    Safety() : def_(default_safety()) {}

    const frm_device_safety_def& def() const { return def_; }
    void configure(const frm_device_safety_def& def) { def_ = def; }

    bool engaged() const { return phase_ != Phase::off; }
    bool faulty() const { return static_cast<bool>(latch_); }
    const FaultLatch& latch() const { return latch_; }
    /// Not while a fault is latched. `most`: the device's own limits.
    void engage(const Six& most);
    void disengage();
    void clear_fault() { latch_.clear(); }
    /// Poses begin anew: if engaged, forces grow from zero once a good state has come.
    void restart();
    /// The device has been stopped: what it displays is nothing.
    void stopped();

    /// What to send of a command, with the deadline that goes with it. May latch a fault.
    Six limit(const Six& command, std::uint64_t deadline_ns);
    /// What came of it. True as fault() is.
    bool observe(const frm_device_state& state);
    /// True if it is new: then the device has to be stopped.
    bool fault(std::uint32_t faults, const char* detail = nullptr, double value = 0);

    void describe(frm_device_safety_state& out) const;

private:
    enum class Phase { off, waiting, on };

    Six wanted(const Six& command);
    Six brake();
    float quick_time() const;
    PassivityLimits linear_limits() const;
    PassivityLimits angular_limits() const;

    frm_device_safety_def def_;
    Six most_;  ///< magnitudes; one number each, in x
    Phase phase_ = Phase::off;
    FaultLatch latch_;
    Ramp ramp_;
    StateChecks checks_;
    Passivity linear_, angular_;
    Six sent_, base_, displayed_, asked_, velocity_;  ///< base_: sent, but for what the passivity controller added
    std::uint64_t deadline_ns_ = 0;
    bool was_asked_ = false, has_state_ = false, held_ = true, ready_ = false;
    float dt_ = 0, cycle_ = 0, braking_ = 0;
    std::uint64_t limited_ = 0, damped_ = 0;
};

}  // namespace frm::device
