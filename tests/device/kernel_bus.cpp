#include "tests/device/kernel_bus.h"

#include <chrono>
#include <fstream>
#include <iterator>

#include "tests/device/kernel_board.h"
#include "tests/support/catch.h"

namespace frm::test {

void wait_until(const std::function<bool()>& done, const std::string& what) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::minutes(1);
    while (!done()) {
        if (std::chrono::steady_clock::now() > end) FAIL("the kernel took over a minute: " << what);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
}

std::string text_of(const std::string& path) {
    std::ifstream file(path);
    return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
}

KernelBus::KernelBus() = default;

KernelBus::~KernelBus() {
    for (auto& [name, board] : boards_) {
        board->pull();
        // A destructor must not fail a test; the next plug would.
        for (int k = 0; k < 5000 && board->known(); ++k) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
}

std::string KernelBus::plug_usb(const char* amplifier, unsigned rotary) {
    auto board = plug_usbip(amplifier, rotary);
    const std::string name = board->name();
    boards_[name] = std::move(board);
    return name;
}

std::string KernelBus::plug_hid(unsigned rotary) {
    auto board = plug_uhid(rotary);
    const std::string name = board->name();
    boards_[name] = std::move(board);
    return name;
}

void KernelBus::set_fault(const std::string& name, int fault) {
    KernelBoard& board = *boards_.at(name);
    if (fault == FRM_SHIM_GONE) {
        board.pull();
        wait_until([&] { return !board.known(); }, name + " should be gone");
        return;
    }
    const std::lock_guard<std::mutex> lock(board.mutex);
    board.board.fault = fault;
    board.changed();
}

void KernelBus::pull(const std::string& name) { boards_.at(name)->pull(); }

void KernelBus::centre(const std::string& name) {
    KernelBoard& board = *boards_.at(name);
    const std::lock_guard<std::mutex> lock(board.mutex);
    board.board.amplifier.hand().place({});
}

frm_shim_view KernelBus::look(const std::string& name) {
    KernelBoard& board = *boards_.at(name);
    const std::lock_guard<std::mutex> lock(board.mutex);
    frm_shim_view view{};
    board.board.look(view);
    return view;
}

}  // namespace frm::test
