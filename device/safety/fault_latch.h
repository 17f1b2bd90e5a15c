// A fault stays until the host has seen it and clears it.
#pragma once

#include <cstdint>

namespace frm::device {

/// The text of one frm_device_fault; of several bits, that of the lowest.
const char* fault_text(std::uint32_t faults);

class FaultLatch {
public:
    explicit operator bool() const { return faults_ != 0; }
    std::uint32_t faults() const { return faults_; }
    /// Of the first fault: what follows from it would only hide it. Empty without one.
    const char* reason() const { return reason_; }
    std::uint64_t count() const { return count_; }

    /// True if these faults were not latched already. `detail`, a printf format for one number, is added to the fault's
    /// text.
    bool set(std::uint32_t faults, const char* detail = nullptr, double value = 0);
    void clear();

private:
    std::uint32_t faults_ = 0;
    std::uint64_t count_ = 0;
    char reason_[128] = {};
};

}  // namespace frm::device
