// The device's end of USB/IP (Documentation/usb/usbip_protocol.rst of the kernel): submitted and unlinked URBs come over a
// socket whose other end was given to vhci_hcd.
#include <endian.h>
#include <errno.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <deque>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <vector>

#include "tests/device/kernel_board.h"
#include "tests/device/usb_descriptors.h"
#include "tests/support/catch.h"

namespace frm::test {
namespace {

const std::string controller = "/sys/devices/platform/vhci_hcd.0/";

enum : std::uint32_t { cmd_submit = 1, cmd_unlink = 2, ret_submit = 3, ret_unlink = 4 };
constexpr std::uint32_t direction_in = 1;

/// 48 bytes, big-endian, each way.
struct Header {
    std::uint32_t command, seqnum, devid, direction, endpoint;
    std::uint32_t flags_or_status;  ///< of a submitted URB and its return; of an unlink: the URB's seqnum, or a status
    std::uint32_t length, start_frame, packets, interval_or_errors;
    std::uint8_t setup[8];
};
static_assert(sizeof(Header) == 48);

struct Port {
    int number = -1;
    std::string device;  ///< the kernel's name of what is plugged in there
};

/// vhci_hcd's table: hub, port, state, speed, ... , the device's name. Port -1: the first free one of high speed.
Port look_at_port(int number) {
    std::istringstream table(text_of(controller + "status"));
    std::string line;
    std::getline(table, line);
    while (std::getline(table, line)) {
        std::istringstream fields(line);
        std::string hub, speed, devid, socket;
        int port = 0, state = 0;
        Port out;
        fields >> hub >> port >> state >> speed >> devid >> socket >> out.device;
        out.number = port;
        constexpr int free_port = 4;
        if (number < 0 ? hub == "hs" && state == free_port : port == number) {
            if (state == free_port) out.device.clear();
            return out;
        }
    }
    return {};
}

class UsbipBoard final : public KernelBoard {
public:
    UsbipBoard(const char* amplifier, unsigned rotary)
        : KernelBoard(amplifier, rotary),
          descriptors_(usb_descriptors(0x0cec, std::string(amplifier) == "simple" ? 0x0203 : 0x0205)) {
        int ends[2];
        REQUIRE(socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) == 0);
        socket_ = ends[0];
        const int port = look_at_port(-1).number;
        REQUIRE(port >= 0);
        serving_ = std::thread([this] { serve(); });
        {
            constexpr int high_speed = 3;
            std::ofstream attach(controller + "attach");
            attach << port << ' ' << ends[1] << ' ' << port + 2 << ' ' << high_speed << std::flush;
            if (!attach) std::perror("vhci_hcd did not take the socket");
        }
        close(ends[1]);  // the kernel has its own hold of it
        wait_until(
            [&] {
                name_ = look_at_port(port).device;
                return known() && std::filesystem::exists(folder() + "/" + name_ + ":1.0");
            },
            "an amplifier on USB should be known");
    }
    ~UsbipBoard() override { end(); }

    std::string name() const override { return name_; }
    void pull() override { shutdown(socket_, SHUT_RDWR); }
    bool known() const override { return name_.find('-') == 1 && std::filesystem::exists(folder()); }
    void changed() override { answer(); }

private:
    struct Waiting {
        std::uint32_t seqnum, length;
    };

    std::string folder() const { return "/sys/bus/usb/devices/" + name_; }

    void end() {
        shutdown(socket_, SHUT_RDWR);
        if (serving_.joinable()) serving_.join();
        close(socket_);
    }

    bool get(void* data, std::size_t size) const {
        return size == 0 || recv(socket_, data, size, MSG_WAITALL) == static_cast<ssize_t>(size);
    }

    void put(const Header& header, const std::uint8_t* data, std::size_t size) const {
        std::vector<std::uint8_t> out(sizeof header + size);
        std::memcpy(out.data(), &header, sizeof header);
        if (size > 0) std::memcpy(out.data() + sizeof header, data, size);
        send(socket_, out.data(), out.size(), MSG_NOSIGNAL);
    }

    /// `length`: what was taken or given; data goes along with what came in.
    void finish(std::uint32_t seqnum, int status, std::size_t length, const std::uint8_t* data = nullptr) const {
        Header h{};
        h.command = htobe32(ret_submit);
        h.seqnum = htobe32(seqnum);
        h.flags_or_status = htobe32(static_cast<std::uint32_t>(status));
        h.length = htobe32(static_cast<std::uint32_t>(length));
        h.packets = 0xFFFFFFFFu;  // not isochronous
        put(h, data, data ? length : 0);
    }

    void control(const Header& h, std::uint32_t seqnum, std::uint32_t length) {
        const std::uint8_t* s = h.setup;
        const unsigned type = s[0], request = s[1], index = s[4];
        constexpr unsigned get_status = 0, clear_feature = 1, get_descriptor = 6, set_configuration = 9,
                           set_interface = 11;
        constexpr unsigned kind_device = 1, kind_configuration = 2;
        if (type == 0x80 && request == get_descriptor && (s[3] == kind_device || s[3] == kind_configuration)) {
            const bool device = s[3] == kind_device;
            const std::uint8_t* data = descriptors_.data() + (device ? 0 : usb_device_descriptor_bytes);
            const std::size_t size =
                device ? usb_device_descriptor_bytes : descriptors_.size() - usb_device_descriptor_bytes;
            return finish(seqnum, 0, std::min<std::size_t>(size, length), data);
        }
        const std::uint8_t nothing[2] = {};
        if ((type & 0x80) && request == get_status)
            return finish(seqnum, 0, std::min<std::size_t>(sizeof nothing, length), nothing);
        if (type == 0x02 && request == clear_feature) {
            if (index & 0x80) board.amplifier.clear();
            return finish(seqnum, 0, 0);
        }
        if ((type == 0x00 && request == set_configuration) || (type == 0x01 && request == set_interface))
            return finish(seqnum, 0, 0);
        finish(seqnum, -EPIPE, 0);
    }

    /// In-transfers that wait and have an answer.
    void answer() {
        while (!waiting_.empty() && board.fault != FRM_SHIM_SILENT) {
            const Waiting urb = waiting_.front();
            if (board.fault == FRM_SHIM_STALL) {
                waiting_.pop_front();
                finish(urb.seqnum, -EPIPE, 0);
                continue;
            }
            spidar_g::Packet reply;
            if (!board.next_reply(reply)) return;
            waiting_.pop_front();
            if (board.fault == FRM_SHIM_SHORT) reply.size /= 2;
            if (reply.size > urb.length)
                finish(urb.seqnum, -EOVERFLOW, 0);
            else
                finish(urb.seqnum, 0, reply.size, reply.bytes.data());
        }
    }

    void unlink(std::uint32_t seqnum, std::uint32_t which) {
        int status = 0;  // it was on its way already
        for (auto i = waiting_.begin(); i != waiting_.end(); ++i) {
            if (i->seqnum != which) continue;
            waiting_.erase(i);
            status = -ECONNRESET;
            break;
        }
        Header h{};
        h.command = htobe32(ret_unlink);
        h.seqnum = htobe32(seqnum);
        h.flags_or_status = htobe32(static_cast<std::uint32_t>(status));
        put(h, nullptr, 0);
    }

    void serve() {
        Header h;
        while (get(&h, sizeof h)) {
            const std::uint32_t seqnum = be32toh(h.seqnum);
            if (be32toh(h.command) == cmd_unlink) {
                const std::lock_guard<std::mutex> lock(mutex);
                unlink(seqnum, be32toh(h.flags_or_status));
                continue;
            }
            if (be32toh(h.command) != cmd_submit) return;
            const std::uint32_t length = be32toh(h.length), endpoint = be32toh(h.endpoint);
            const bool in = be32toh(h.direction) == direction_in;
            std::vector<std::uint8_t> data(in ? 0 : length);
            if (!get(data.data(), data.size())) return;
            const std::lock_guard<std::mutex> lock(mutex);
            if (endpoint == 0) {
                control(h, seqnum, length);
            } else if (endpoint == 2 && !in) {
                board.amplifier.receive(data.data(), data.size());
                finish(seqnum, 0, length);
            } else if (endpoint == 6 && in) {
                waiting_.push_back({seqnum, length});
            } else {
                finish(seqnum, -EPIPE, 0);
            }
            answer();
        }
    }

    std::vector<std::uint8_t> descriptors_;
    int socket_ = -1;
    std::string name_;
    std::deque<Waiting> waiting_;
    std::thread serving_;
};

}  // namespace

std::unique_ptr<KernelBoard> plug_usbip(const char* amplifier, unsigned rotary) {
    return std::make_unique<UsbipBoard>(amplifier, rotary);
}

}  // namespace frm::test
