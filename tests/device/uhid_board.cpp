// A board of the HID class that the kernel's uhid brings to life; hid-generic and hidraw are the kernel's.
#include <errno.h>
#include <fcntl.h>
#include <linux/uhid.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "tests/device/kernel_board.h"
#include "tests/support/catch.h"

namespace frm::test {
namespace {

class UhidBoard final : public KernelBoard {
public:
    explicit UhidBoard(unsigned rotary) : KernelBoard("simple", rotary), node_(open("/dev/uhid", O_RDWR | O_CLOEXEC)) {
        REQUIRE(node_ >= 0);
        static int made = 0;
        const std::string unique = "frm-" + std::to_string(++made);
        uhid_event e{};
        e.type = UHID_CREATE2;
        uhid_create2_req& create = e.u.create2;
        std::snprintf(reinterpret_cast<char*>(create.name), sizeof create.name, "frm mock");
        std::snprintf(reinterpret_cast<char*>(create.uniq), sizeof create.uniq, "%s", unique.c_str());
        constexpr std::uint16_t bus_usb = 3;
        create.bus = bus_usb;
        create.vendor = 0x04d8, create.product = 0x003f;
        create.rd_size = sizeof frm_shim_report_descriptor;
        std::memcpy(create.rd_data, frm_shim_report_descriptor, sizeof frm_shim_report_descriptor);
        REQUIRE(tell(e));
        serving_ = std::thread([this] { serve(); });
        wait_until(
            [&] {
                name_ = find(unique);
                return !name_.empty();
            },
            "a board of the HID class should be known");
    }
    ~UhidBoard() override {
        ended_ = true;
        serving_.join();
        close(node_);
    }

    std::string name() const override { return name_; }
    void pull() override {
        uhid_event e{};
        e.type = UHID_DESTROY;
        tell(e);
    }
    bool known() const override { return std::filesystem::exists("/sys/class/hidraw/" + name_); }

private:
    bool tell(const uhid_event& e) const { return write(node_, &e, sizeof e) == static_cast<ssize_t>(sizeof e); }

    static std::string find(const std::string& unique) {
        std::error_code none;
        for (const auto& entry : std::filesystem::directory_iterator("/sys/class/hidraw", none)) {
            const std::string node = entry.path().filename().string();
            if (text_of(entry.path().string() + "/device/uevent").find("HID_UNIQ=" + unique + "\n") !=
                    std::string::npos &&
                std::filesystem::exists("/dev/" + node))
                return node;
        }
        return {};
    }

    void took(const uhid_output_req& report) {
        const std::lock_guard<std::mutex> lock(mutex);
        // The report's number comes first, 0 for none.
        if (report.size > 0) board.amplifier.receive(report.data + 1, report.size - 1u);
        spidar_g::Packet reply;
        while (board.next_report(reply)) {
            if (board.fault == FRM_SHIM_SILENT) continue;
            uhid_event e{};
            e.type = UHID_INPUT2;
            e.u.input2.size = static_cast<std::uint16_t>(reply.size);
            std::memcpy(e.u.input2.data, reply.bytes.data(), reply.size);
            tell(e);
        }
    }

    void serve() {
        while (!ended_) {
            pollfd waits{node_, POLLIN, 0};
            if (poll(&waits, 1, 20) <= 0 || !(waits.revents & POLLIN)) continue;
            uhid_event e{};
            if (read(node_, &e, sizeof e) <= 0) continue;
            if (e.type == UHID_OUTPUT) took(e.u.output);
            if (e.type == UHID_GET_REPORT || e.type == UHID_SET_REPORT) {
                uhid_event no{};
                const bool get = e.type == UHID_GET_REPORT;
                no.type = get ? UHID_GET_REPORT_REPLY : UHID_SET_REPORT_REPLY;
                if (get)
                    no.u.get_report_reply.id = e.u.get_report.id, no.u.get_report_reply.err = EIO;
                else
                    no.u.set_report_reply.id = e.u.set_report.id, no.u.set_report_reply.err = EIO;
                tell(no);
            }
        }
    }

    int node_;
    std::string name_;
    std::atomic<bool> ended_{false};
    std::thread serving_;
};

}  // namespace

std::unique_ptr<KernelBoard> plug_uhid(unsigned rotary) { return std::make_unique<UhidBoard>(rotary); }

}  // namespace frm::test
