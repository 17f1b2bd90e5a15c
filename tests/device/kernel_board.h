// One simulated board that the kernel takes for a real one.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "tests/device/simulated_board.h"

namespace frm::test {

class KernelBoard {
public:
    virtual ~KernelBoard() = default;

    /// As the kernel calls it.
    virtual std::string name() const = 0;
    /// Pulls it out.
    virtual void pull() = 0;
    /// Whether the kernel still has it.
    virtual bool known() const = 0;
    /// After `fault` has changed: what waited for an answer may have one now. `mutex` is held.
    virtual void changed() {}

    std::mutex mutex;  ///< of `board`
    SimulatedBoard board;

protected:
    KernelBoard(const char* amplifier, unsigned rotary) : board(amplifier, rotary) {}
};

/// An amplifier behind USB/IP, plugged into the first free port of vhci_hcd (usbip_board.cpp).
std::unique_ptr<KernelBoard> plug_usbip(const char* amplifier, unsigned rotary);
/// A board of the HID class behind /dev/uhid (uhid_board.cpp).
std::unique_ptr<KernelBoard> plug_uhid(unsigned rotary);

/// Waits; fails the test with `what` after a minute, which nothing that goes well takes.
void wait_until(const std::function<bool()>& done, const std::string& what);
/// A whole small file, empty if it is not there.
std::string text_of(const std::string& path);

}  // namespace frm::test
