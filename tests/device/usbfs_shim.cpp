// An LD_PRELOAD library behind which a simulated SPIDAR-G amplifier is on USB, or a board of the HID class: the real
// libusb and hidapi talk to it through device nodes that are served here. What lies in sysfs comes from umockdev; see
// usb_bus.h.
//
// usbfs: the descriptor that libusb gets is the write end of a non-blocking pipe of one page. Full, it does not poll as
// writable, which is libusb's sign for a finished URB; so it is full but for when one waits to be reaped. With the read
// end closed it polls as an error, which libusb takes for removal. hidraw: a socket that keeps the boundaries of
// messages.
#include "tests/device/usbfs_shim.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/hidraw.h>
#include <linux/usbdevice_fs.h>
#include <poll.h>
#include <pthread.h>
#include <stdarg.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "tests/device/simulated_board.h"

namespace {

using frm::spidar_g::Packet;

/// One plug: the board, and whatever has it open.
struct Plug {
    Plug(bool on_hid, const char* amplifier, unsigned rotary) : hid(on_hid), board(amplifier, rotary) {}

    bool hid;
    frm::test::SimulatedBoard board;
    bool gone = false;
    // usbfs
    int ours = -1, theirs = -1;
    std::deque<usbdevfs_urb*> waiting, finished;
    // hidraw
    std::thread answers;
};

std::mutex& mutex() {
    static std::mutex m;
    return m;
}
std::map<std::string, std::shared_ptr<Plug>>& plugs() {
    static auto* all = new std::map<std::string, std::shared_ptr<Plug>>;
    return *all;
}
std::map<int, std::shared_ptr<Plug>>& opened() {
    static auto* all = new std::map<int, std::shared_ptr<Plug>>;
    return *all;
}

template <typename Function>
Function next(const char* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

int real_close(int fd) {
    static const auto f = next<int (*)(int)>("close");
    return f(fd);
}

void fill(Plug& plug) {
    char page[4096] = {};
    while (write(plug.theirs, page, sizeof page) > 0) {
    }
    while (write(plug.theirs, page, 1) > 0) {
    }
}

void drain(const Plug& plug) {
    char page[4096];
    while (read(plug.ours, page, sizeof page) > 0) {
    }
}

int open_usb(const std::shared_ptr<Plug>& plug) {
    if (plug->gone) return errno = ENODEV, -1;
    if (plug->theirs >= 0) return errno = EBUSY, -1;
    int ends[2];
    if (pipe2(ends, O_NONBLOCK | O_CLOEXEC) != 0) return -1;
    fcntl(ends[1], F_SETPIPE_SZ, 4096);
    plug->ours = ends[0], plug->theirs = ends[1];
    plug->waiting.clear(), plug->finished.clear();
    fill(*plug);
    opened()[plug->theirs] = plug;
    return plug->theirs;
}

/// A board answers on a thread of its own, as far as the reports are whole.
void serve(const std::shared_ptr<Plug>& plug, int fd) {
    std::uint8_t report[frm::spidar_g::largest_packet + 1];
    for (;;) {
        const ssize_t got = recv(fd, report, sizeof report, 0);
        if (got <= 0) break;
        const std::lock_guard<std::mutex> lock(mutex());
        // hidapi writes the report's number first, 0 for none; the board sees what follows.
        plug->board.amplifier.receive(report + 1, static_cast<std::size_t>(got - 1));
        Packet reply;
        while (plug->board.next_report(reply)) {
            if (plug->board.fault != FRM_SHIM_SILENT) send(fd, reply.bytes.data(), reply.size, MSG_NOSIGNAL);
        }
    }
    real_close(fd);
}

int open_hid(const std::shared_ptr<Plug>& plug) {
    if (plug->gone) return errno = ENODEV, -1;
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) return -1;
    plug->ours = ends[0], plug->theirs = ends[1];
    opened()[plug->theirs] = plug;
    plug->answers = std::thread(serve, plug, ends[0]);
    return plug->theirs;
}

/// -2: not one of ours.
int try_open(const char* path) {
    const std::lock_guard<std::mutex> lock(mutex());
    const auto found = plugs().find(path);
    if (found == plugs().end()) return -2;
    return found->second->hid ? open_hid(found->second) : open_usb(found->second);
}

void finish(Plug& plug, usbdevfs_urb* urb, int status, int length) {
    urb->status = status;
    urb->actual_length = length;
    plug.finished.push_back(urb);
    drain(plug);
}

/// In-transfers that wait and have an answer.
void answer(Plug& plug) {
    while (!plug.waiting.empty() && plug.board.fault != FRM_SHIM_SILENT) {
        usbdevfs_urb* urb = plug.waiting.front();
        if (plug.board.fault == FRM_SHIM_STALL) {
            plug.waiting.pop_front();
            finish(plug, urb, -EPIPE, 0);
            continue;
        }
        Packet reply;
        if (!plug.board.next_reply(reply)) return;
        plug.waiting.pop_front();
        if (plug.board.fault == FRM_SHIM_SHORT) reply.size /= 2;
        if (reply.size > static_cast<std::size_t>(urb->buffer_length)) {
            finish(plug, urb, -EOVERFLOW, 0);
            continue;
        }
        std::memcpy(urb->buffer, reply.bytes.data(), reply.size);
        finish(plug, urb, 0, static_cast<int>(reply.size));
    }
}

int usb_ioctl(Plug& plug, unsigned long request, void* argument) {
    if (plug.gone && request != USBDEVFS_REAPURBNDELAY) return errno = ENODEV, -1;
    switch (request) {
        case USBDEVFS_GET_CAPABILITIES:
            *static_cast<__u32*>(argument) = USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_REAP_AFTER_DISCONNECT;
            return 0;
        case USBDEVFS_CLAIMINTERFACE:
        case USBDEVFS_RELEASEINTERFACE:
        case USBDEVFS_DISCONNECT_CLAIM:
            return 0;
        case USBDEVFS_CLEAR_HALT:
            if (*static_cast<unsigned*>(argument) & 0x80) plug.board.amplifier.clear();
            return 0;
        case USBDEVFS_SUBMITURB: {
            auto* urb = static_cast<usbdevfs_urb*>(argument);
            if (urb->type != USBDEVFS_URB_TYPE_BULK || (urb->endpoint != 0x02 && urb->endpoint != 0x86))
                return errno = EINVAL, -1;
            if (urb->endpoint == 0x02) {
                plug.board.amplifier.receive(static_cast<const std::uint8_t*>(urb->buffer),
                                             static_cast<std::size_t>(urb->buffer_length));
                finish(plug, urb, 0, urb->buffer_length);
            } else {
                plug.waiting.push_back(urb);
            }
            answer(plug);
            return 0;
        }
        case USBDEVFS_DISCARDURB: {
            auto* urb = static_cast<usbdevfs_urb*>(argument);
            const auto found = std::find(plug.waiting.begin(), plug.waiting.end(), urb);
            if (found == plug.waiting.end()) return errno = EINVAL, -1;
            plug.waiting.erase(found);
            finish(plug, urb, -ENOENT, 0);
            return 0;
        }
        case USBDEVFS_REAPURBNDELAY: {
            if (plug.finished.empty()) return errno = plug.gone ? ENODEV : EAGAIN, -1;
            *static_cast<usbdevfs_urb**>(argument) = plug.finished.front();
            plug.finished.pop_front();
            if (plug.finished.empty() && !plug.gone) fill(plug);
            return 0;
        }
        default:
            return errno = ENOTTY, -1;
    }
}

int hid_ioctl(const Plug& plug, unsigned long request, void* argument) {
    if (plug.gone) return errno = ENODEV, -1;
    if (request == HIDIOCGRDESCSIZE) {
        *static_cast<int*>(argument) = sizeof frm_shim_report_descriptor;
        return 0;
    }
    if (request == HIDIOCGRDESC) {
        std::memcpy(static_cast<hidraw_report_descriptor*>(argument)->value, frm_shim_report_descriptor,
                    sizeof frm_shim_report_descriptor);
        return 0;
    }
    return errno = ENOTTY, -1;
}

std::shared_ptr<Plug> plug_of(int fd) {
    const auto found = opened().find(fd);
    return found == opened().end() ? nullptr : found->second;
}

}  // namespace

#define EXPORTED extern "C" __attribute__((visibility("default")))

EXPORTED void frm_shim_plug(const char* path, int hid, const char* amplifier, unsigned rotary) {
    auto plug = std::make_shared<Plug>(hid != 0, amplifier, rotary);
    const std::lock_guard<std::mutex> lock(mutex());
    plugs()[path] = std::move(plug);
}

EXPORTED void frm_shim_set_fault(const char* path, int fault) {
    const std::lock_guard<std::mutex> lock(mutex());
    Plug& plug = *plugs().at(path);
    plug.board.fault = fault;
    if (fault == FRM_SHIM_GONE) {
        plug.gone = true;
        while (!plug.waiting.empty()) {
            usbdevfs_urb* urb = plug.waiting.front();
            plug.waiting.pop_front();
            urb->status = -ENODEV, urb->actual_length = 0;
            plug.finished.push_back(urb);
        }
        if (plug.ours >= 0) {
            if (plug.hid)
                shutdown(plug.ours, SHUT_RDWR);
            else
                real_close(plug.ours);
            plug.ours = -1;
        }
    } else if (!plug.hid && plug.theirs >= 0) {
        answer(plug);
    }
}

EXPORTED void frm_shim_centre(const char* path) {
    const std::lock_guard<std::mutex> lock(mutex());
    plugs().at(path)->board.amplifier.hand().place({});
}

EXPORTED void frm_shim_look(const char* path, frm_shim_view* view) {
    const std::lock_guard<std::mutex> lock(mutex());
    plugs().at(path)->board.look(*view);
}

EXPORTED int open(const char* path, int flags, ...) {
    const int fd = try_open(path);
    if (fd != -2) return fd;
    va_list list;
    va_start(list, flags);
    const mode_t mode = static_cast<mode_t>(va_arg(list, int));
    va_end(list);
    static const auto f = next<int (*)(const char*, int, ...)>("open");
    return f(path, flags, mode);
}

EXPORTED int open64(const char* path, int flags, ...) {
    const int fd = try_open(path);
    if (fd != -2) return fd;
    va_list list;
    va_start(list, flags);
    const mode_t mode = static_cast<mode_t>(va_arg(list, int));
    va_end(list);
    static const auto f = next<int (*)(const char*, int, ...)>("open64");
    return f(path, flags, mode);
}

// Debian's libusb is built with _FORTIFY_SOURCE, which opens through these.
EXPORTED int __open_2(const char* path, int flags) {
    const int fd = try_open(path);
    static const auto f = next<int (*)(const char*, int)>("__open_2");
    return fd != -2 ? fd : f(path, flags);
}

EXPORTED int __open64_2(const char* path, int flags) {
    const int fd = try_open(path);
    static const auto f = next<int (*)(const char*, int)>("__open64_2");
    return fd != -2 ? fd : f(path, flags);
}

EXPORTED int ioctl(int fd, unsigned long request, ...) noexcept {
    va_list list;
    va_start(list, request);
    void* argument = va_arg(list, void*);
    va_end(list);
    {
        const std::lock_guard<std::mutex> lock(mutex());
        if (const auto plug = plug_of(fd))
            return plug->hid ? hid_ioctl(*plug, request, argument) : usb_ioctl(*plug, request, argument);
    }
    static const auto f = next<int (*)(int, unsigned long, ...)>("ioctl");
    return f(fd, request, argument);
}

EXPORTED int close(int fd) {
    std::thread answers;
    {
        const std::lock_guard<std::mutex> lock(mutex());
        if (const auto plug = plug_of(fd)) {
            opened().erase(fd);
            if (plug->hid)
                answers = std::move(plug->answers);
            else if (plug->ours >= 0)
                real_close(plug->ours);
            plug->ours = plug->theirs = -1;
        }
    }
    const int result = real_close(fd);
    if (answers.joinable()) answers.join();
    return result;
}
