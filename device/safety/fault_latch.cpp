#include "device/safety/fault_latch.h"

#include <cstdio>
#include <cstring>

#include "frm.h"

namespace frm::device {

const char* fault_text(std::uint32_t faults) {
    // What takes the calibration away says more than that it is gone.
    if (faults & ~static_cast<std::uint32_t>(FRM_DEVICE_FAULT_UNCALIBRATED))
        faults &= ~static_cast<std::uint32_t>(FRM_DEVICE_FAULT_UNCALIBRATED);
    switch (faults & (~faults + 1)) {
        case FRM_DEVICE_FAULT_NONE:
            return "";
        case FRM_DEVICE_FAULT_SHORT_PACKET:
            return "the device sent a packet that is too short";
        case FRM_DEVICE_FAULT_TIMEOUT:
            return "the device did not answer in time";
        case FRM_DEVICE_FAULT_TRANSFER:
            return "the bus refused a transfer, or the device answered what cannot be";
        case FRM_DEVICE_FAULT_LOST_COUNT:
            return "the encoders may have wrapped unseen: calibrate the device";
        case FRM_DEVICE_FAULT_UNPLUGGED:
            return "the device was unplugged";
        case FRM_DEVICE_FAULT_STUCK_ENCODER:
            return "an encoder is stuck";
        case FRM_DEVICE_FAULT_SLACK_STRING:
            return "a string is slack";
        case FRM_DEVICE_FAULT_BROKEN_STRING:
            return "a string is broken";
        case FRM_DEVICE_FAULT_UNCALIBRATED:
            return "the device is not calibrated: calibrate it with the grip at the reference pose";
        case FRM_DEVICE_FAULT_COMMAND:
            return "the commanded wrench is not finite";
        case FRM_DEVICE_FAULT_STEP:
            return "the commanded wrench leapt";
        case FRM_DEVICE_FAULT_SPEED:
            return "the grip ran away";
        case FRM_DEVICE_FAULT_DEADLINE:
            return "no exchange came before the deadline";
        case FRM_DEVICE_FAULT_STATE:
            return "the device gave a state that cannot be";
        case FRM_DEVICE_FAULT_JUMP:
            return "the grip's pose leapt";
        case FRM_DEVICE_FAULT_STALE:
            return "the device's sequence or time stands still or runs backwards";
        case FRM_DEVICE_FAULT_DRIVER:
            return "the device's driver failed";
        default:
            return "the driver reports a fault that this library does not know";
    }
}

bool FaultLatch::set(std::uint32_t faults, const char* detail, double value) {
    if ((faults & ~faults_) == 0) return false;
    if (faults_ == 0) {
        const int length = std::snprintf(reason_, sizeof reason_, "%s", fault_text(faults));
        if (detail && length > 0 && static_cast<std::size_t>(length) < sizeof reason_)
            std::snprintf(reason_ + length, sizeof reason_ - static_cast<std::size_t>(length), detail, value);
        ++count_;
    }
    faults_ |= faults;
    return true;
}

void FaultLatch::clear() {
    faults_ = 0;
    std::memset(reason_, 0, sizeof reason_);
}

}  // namespace frm::device
