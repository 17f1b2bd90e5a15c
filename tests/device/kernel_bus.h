// A USB bus and HID boards for tests that run under a kernel of their own (kernel.sh): the kernel's own USB, with simulated
// amplifiers plugged in through USB/IP, and its own hidraw, with boards behind /dev/uhid. Nothing of it is mocked but the
// amplifier. As usb_bus.h otherwise.
#pragma once

#include <map>
#include <memory>
#include <string>

#include "tests/device/usbfs_shim.h"

namespace frm::test {

class KernelBoard;

class KernelBus {
public:
    KernelBus();
    /// Unplugs what is left.
    ~KernelBus();
    KernelBus(const KernelBus&) = delete;
    KernelBus& operator=(const KernelBus&) = delete;

    /// Plugged in and known to the kernel, with its device node; returns the name by which the others know it.
    std::string plug_usb(const char* amplifier, unsigned rotary);
    std::string plug_hid(unsigned rotary);
    /// FRM_SHIM_GONE returns when the kernel has noticed.
    void set_fault(const std::string& name, int fault);
    /// Pulled out without waiting for anybody.
    void pull(const std::string& name);
    void centre(const std::string& name);
    frm_shim_view look(const std::string& name);

private:
    std::map<std::string, std::unique_ptr<KernelBoard>> boards_;
};

}  // namespace frm::test
