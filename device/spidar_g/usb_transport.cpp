#include "device/spidar_g/usb_transport.h"

#include <libusb.h>

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "device/spidar_g/loaded_library.h"

namespace frm::spidar_g {
namespace {

constexpr unsigned char endpoint_out = 0x02, endpoint_in = 0x86;
constexpr int interface_number = 0;

// How long transfers may take to come back after they were cancelled. The kernel gives them back at once; a transfer
// that does not come back means that nothing works any more.
constexpr std::uint64_t cancel_ns = 100'000'000;

struct LibUsb {
    LoadedLibrary library{{"libusb-1.0.so.0", "libusb-1.0.0.dylib"}, "libusb-1.0"};
    decltype(&libusb_init) init;
    decltype(&libusb_exit) exit;
    decltype(&libusb_get_device_list) get_device_list;
    decltype(&libusb_free_device_list) free_device_list;
    decltype(&libusb_get_device_descriptor) get_device_descriptor;
    decltype(&libusb_get_bus_number) get_bus_number;
    decltype(&libusb_get_device_address) get_device_address;
    decltype(&libusb_open) open;
    decltype(&libusb_close) close;
    decltype(&libusb_claim_interface) claim_interface;
    decltype(&libusb_release_interface) release_interface;
    decltype(&libusb_clear_halt) clear_halt;
    decltype(&libusb_alloc_transfer) alloc_transfer;
    decltype(&libusb_free_transfer) free_transfer;
    decltype(&libusb_submit_transfer) submit_transfer;
    decltype(&libusb_cancel_transfer) cancel_transfer;
    decltype(&libusb_handle_events_timeout_completed) handle_events;
    decltype(&libusb_strerror) strerror;

    LibUsb() {
        library.find("libusb_init", init);
        library.find("libusb_exit", exit);
        library.find("libusb_get_device_list", get_device_list);
        library.find("libusb_free_device_list", free_device_list);
        library.find("libusb_get_device_descriptor", get_device_descriptor);
        library.find("libusb_get_bus_number", get_bus_number);
        library.find("libusb_get_device_address", get_device_address);
        library.find("libusb_open", open);
        library.find("libusb_close", close);
        library.find("libusb_claim_interface", claim_interface);
        library.find("libusb_release_interface", release_interface);
        library.find("libusb_clear_halt", clear_halt);
        library.find("libusb_alloc_transfer", alloc_transfer);
        library.find("libusb_free_transfer", free_transfer);
        library.find("libusb_submit_transfer", submit_transfer);
        library.find("libusb_cancel_transfer", cancel_transfer);
        library.find("libusb_handle_events_timeout_completed", handle_events);
        library.find("libusb_strerror", strerror);
    }
};

/// A session with libusb; devices that were found in it share it.
struct Session {
    LibUsb usb;
    libusb_context* context = nullptr;

    Session() {
        const int failure = usb.init(&context);
        if (failure != 0) throw Error(FRM_ERROR_DEVICE, "libusb: %s", usb.strerror(failure));
    }
    ~Session() { usb.exit(context); }
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;
};

class UsbTransport final : public Transport {
public:
    UsbTransport(std::shared_ptr<Session> session, libusb_device_handle* handle, std::uint64_t timeout_ns)
        : session_(std::move(session)), handle_(handle), timeout_ns_(timeout_ns) {
        for (Transfer& t : *transfers_) {
            t.transfer = session_->usb.alloc_transfer(0);
            if (!t.transfer) {
                release();
                throw std::bad_alloc();
            }
        }
    }
    ~UsbTransport() override { release(); }

    void recover() override {
        if (lost_) return;
        session_->usb.clear_halt(handle_, endpoint_out);
        session_->usb.clear_halt(handle_, endpoint_in);
        // Replies to what was asked before; a reply that is read one cycle late would stay late.
        Packet old;
        for (int i = 0; i < 4 && !lost_; ++i)
            if (run({}, largest_packet, old, 2'000'000) != Carried::whole && old.size == 0) break;
    }

    Carried send(const Request& request) override {
        Packet none;
        return run(request, 0, none, timeout_ns_);
    }

    Carried cycle(const Request& request, std::size_t size, Packet& reply) override {
        return run(request, size, reply, timeout_ns_);
    }

    std::uint64_t now_ns() override { return steady_now_ns(); }
    bool runs_by_itself() const override { return true; }

private:
    struct Transfer {
        libusb_transfer* transfer = nullptr;
        Packet packet;
        int done = 1;
        UsbTransport* owner = nullptr;
    };

    static void LIBUSB_CALL completed(libusb_transfer* transfer) {
        auto& t = *static_cast<Transfer*>(transfer->user_data);
        t.done = 1;
        t.owner->pending_ -= 1;
        t.owner->all_done_ = t.owner->pending_ == 0;
    }

    Carried submit(Transfer& t, unsigned char endpoint, std::size_t size) {
        t.owner = this;
        // No timeout of libusb's own: it would arm a timer for each transfer, and this waits for all of them together.
        libusb_fill_bulk_transfer(t.transfer, handle_, endpoint, t.packet.bytes.data(), static_cast<int>(size),
                                  completed, &t, 0);
        const int failure = session_->usb.submit_transfer(t.transfer);
        if (failure == LIBUSB_ERROR_NO_DEVICE) return Carried::unplugged;
        if (failure != 0) return Carried::refused;
        t.done = 0;
        ++pending_;
        return Carried::whole;
    }

    /// Handles events until all transfers are back or the time is over.
    void wait(std::uint64_t until) {
        all_done_ = pending_ == 0;
        while (pending_ > 0) {
            const std::uint64_t now = steady_now_ns();
            if (now >= until) return;
            timeval time{};
            time.tv_usec = static_cast<suseconds_t>(std::min<std::uint64_t>((until - now) / 1000 + 1, 500'000));
            const int failure = session_->usb.handle_events(session_->context, &time, &all_done_);
            if (failure != 0 && failure != LIBUSB_ERROR_INTERRUPTED) return;
        }
    }

    Carried run(const Request& request, std::size_t size, Packet& reply, std::uint64_t timeout) {
        reply.size = 0;
        if (lost_) return Carried::unplugged;
        const std::uint64_t start = steady_now_ns();
        Carried carried = Carried::whole;
        std::size_t used = 0;
        for (; used < request.count && carried == Carried::whole; ++used) {
            (*transfers_)[used].packet = request.packets[used];
            carried = submit((*transfers_)[used], endpoint_out, request.packets[used].size);
        }
        Transfer& in = (*transfers_)[2];
        // The bulk pipe counts in packets of 512 bytes: asking for less than comes is an overflow, which loses all.
        if (size > 0 && carried == Carried::whole) carried = submit(in, endpoint_in, largest_packet);
        const bool asked = size > 0 && carried == Carried::whole;
        if (carried == Carried::whole) wait(start + timeout);
        const bool late = pending_ > 0 && carried == Carried::whole;
        if (pending_ > 0) {
            for (Transfer& t : *transfers_)
                if (!t.done) session_->usb.cancel_transfer(t.transfer);
            wait(steady_now_ns() + cancel_ns);
        }
        if (pending_ > 0) lost_ = true;
        if (lost_ || carried == Carried::unplugged) {
            lost_ = true;
            return Carried::unplugged;
        }
        for (std::size_t i = 0; i < transfers_->size(); ++i) {
            if (i < 2 ? i >= used : !asked) continue;
            switch ((*transfers_)[i].transfer->status) {
                case LIBUSB_TRANSFER_NO_DEVICE:
                    lost_ = true;
                    return Carried::unplugged;
                case LIBUSB_TRANSFER_STALL:
                case LIBUSB_TRANSFER_ERROR:
                case LIBUSB_TRANSFER_OVERFLOW:
                    carried = Carried::refused;
                    break;
                default:
                    break;
            }
        }
        if (carried != Carried::whole) return carried;
        if (asked) {
            reply.size = static_cast<std::size_t>(std::max(in.transfer->actual_length, 0));
            reply.bytes = in.packet.bytes;
        }
        if (late) return Carried::too_late;
        return reply.size < size ? Carried::cut_off : Carried::whole;
    }

    void release() {
        // A transfer that never came back still belongs to the kernel: better a leak than memory written to later.
        if (pending_ > 0) {
            transfers_.release();
            new std::shared_ptr<Session>(session_);
            return;
        }
        for (Transfer& t : *transfers_)
            if (t.transfer) session_->usb.free_transfer(t.transfer);
        session_->usb.release_interface(handle_, interface_number);
        session_->usb.close(handle_);
    }

    std::shared_ptr<Session> session_;
    libusb_device_handle* handle_;
    std::uint64_t timeout_ns_;
    std::unique_ptr<std::array<Transfer, 3>> transfers_ =
        std::make_unique<std::array<Transfer, 3>>();  ///< two out, one in
    int pending_ = 0, all_done_ = 0;
    bool lost_ = false;
};

struct Found {
    libusb_device* device;
    int bus, address;
};

}  // namespace

std::vector<std::unique_ptr<Transport>> open_usb(const Configuration& configuration) {
    auto session = std::make_shared<Session>();
    const LibUsb& usb = session->usb;
    libusb_device** list = nullptr;
    const ssize_t count = usb.get_device_list(session->context, &list);
    if (count < 0) throw Error(FRM_ERROR_DEVICE, "libusb: %s", usb.strerror(static_cast<int>(count)));
    std::vector<Found> found;
    for (ssize_t i = 0; i < count; ++i) {
        libusb_device_descriptor d{};
        if (usb.get_device_descriptor(list[i], &d) == 0 && d.idVendor == configuration.vendor &&
            d.idProduct == configuration.product)
            found.push_back({list[i], usb.get_bus_number(list[i]), usb.get_device_address(list[i])});
    }
    std::sort(found.begin(), found.end(),
              [](const Found& a, const Found& b) { return a.bus != b.bus ? a.bus < b.bus : a.address < b.address; });
    std::vector<std::unique_ptr<Transport>> out;
    int failure = 0;
    for (const Found& f : found) {
        libusb_device_handle* handle = nullptr;
        int failed = usb.open(f.device, &handle);
        if (failed == 0) {
            failed = usb.claim_interface(handle, interface_number);
            if (failed != 0) usb.close(handle);
        }
        if (failed == 0)
            out.push_back(std::make_unique<UsbTransport>(session, handle, configuration.timeout_ns));
        else
            failure = failed;
    }
    usb.free_device_list(list, 1);
    if (out.empty() && failure != 0)
        throw Error(FRM_ERROR_DEVICE, "a SPIDAR-G's amplifier (USB %04x:%04x) is there, but cannot be opened: %s",
                    configuration.vendor, configuration.product, usb.strerror(failure));
    return out;
}

}  // namespace frm::spidar_g
