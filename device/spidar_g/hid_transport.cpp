#include "device/spidar_g/hid_transport.h"

#include <hidapi.h>

#include <algorithm>
#include <string>

#include "core/error.h"
#include "device/spidar_g/loaded_library.h"

namespace frm::spidar_g {
namespace {

struct HidApi {
    LoadedLibrary library{{"libhidapi-hidraw.so.0", "libhidapi-libusb.so.0", "libhidapi.so.0", "libhidapi.dylib"},
                          "hidapi"};
    decltype(&hid_init) init;
    decltype(&hid_enumerate) enumerate;
    decltype(&hid_free_enumeration) free_enumeration;
    decltype(&hid_open_path) open_path;
    decltype(&hid_close) close;
    decltype(&hid_write) write;
    decltype(&hid_read_timeout) read_timeout;

    HidApi() {
        library.find("hid_init", init);
        library.find("hid_enumerate", enumerate);
        library.find("hid_free_enumeration", free_enumeration);
        library.find("hid_open_path", open_path);
        library.find("hid_close", close);
        library.find("hid_write", write);
        library.find("hid_read_timeout", read_timeout);
        init();
    }
};

class HidTransport final : public Transport {
public:
    HidTransport(std::shared_ptr<HidApi> api, hid_device* device, const Configuration& configuration)
        : api_(std::move(api)),
          device_(device),
          report_bytes_(configuration.report_bytes),
          stop_(configuration.report_stop),
          timeout_ns_(configuration.timeout_ns),
          report_(configuration.report_bytes + 1) {
        if (!configuration.report_start.empty())
            write(configuration.report_start.data(), configuration.report_start.size());
    }
    ~HidTransport() override {
        if (!stop_.empty() && !lost_) write(stop_.data(), stop_.size());
        api_->close(device_);
    }

    void recover() override {
        // Bounded: a board that sends without being asked does not hold this up.
        for (int i = 0; i < 64 && !lost_; ++i)
            if (api_->read_timeout(device_, report_.data(), report_bytes_, 0) <= 0) return;
    }

    Carried send(const Request& request) override {
        for (std::size_t i = 0; i < request.count; ++i)
            if (!write(request.packets[i].bytes.data(), request.packets[i].size)) return Carried::unplugged;
        return Carried::whole;
    }

    Carried cycle(const Request& request, std::size_t size, Packet& reply) override {
        reply.size = 0;
        const Carried sent = send(request);
        if (sent != Carried::whole) return sent;
        // hidapi counts in milliseconds.
        const int got = api_->read_timeout(device_, reply.bytes.data(), std::min(report_bytes_, reply.bytes.size()),
                                           static_cast<int>((timeout_ns_ + 999'999) / 1'000'000));
        if (got < 0) {
            lost_ = true;
            return Carried::unplugged;
        }
        if (got == 0) return Carried::too_late;
        reply.size = static_cast<std::size_t>(got);
        return reply.size < size ? Carried::cut_off : Carried::whole;
    }

    std::uint64_t now_ns() override { return steady_now_ns(); }
    bool runs_by_itself() const override { return true; }

private:
    /// Report number 0: the device has only one kind.
    bool write(const std::uint8_t* data, std::size_t size) {
        if (lost_) return false;
        std::fill(report_.begin(), report_.end(), std::uint8_t{0});
        std::copy(data, data + std::min(size, report_bytes_), report_.begin() + 1);
        lost_ = api_->write(device_, report_.data(), report_.size()) < 0;
        return !lost_;
    }

    std::shared_ptr<HidApi> api_;
    hid_device* device_;
    std::size_t report_bytes_;
    std::vector<std::uint8_t> stop_;
    std::uint64_t timeout_ns_;
    std::vector<std::uint8_t> report_;
    bool lost_ = false;
};

}  // namespace

std::vector<std::unique_ptr<Transport>> open_hid(const Configuration& configuration) {
    auto api = std::make_shared<HidApi>();
    std::vector<std::string> paths;
    hid_device_info* list = api->enumerate(configuration.vendor, configuration.product);
    for (const hid_device_info* d = list; d; d = d->next) paths.emplace_back(d->path);
    api->free_enumeration(list);
    std::sort(paths.begin(), paths.end());
    std::vector<std::unique_ptr<Transport>> out;
    for (const std::string& path : paths)
        if (hid_device* device = api->open_path(path.c_str()))
            out.push_back(std::make_unique<HidTransport>(api, device, configuration));
    if (out.empty() && !paths.empty())
        throw Error(FRM_ERROR_DEVICE, "a SPIDAR-G's board (HID %04x:%04x) is there, but cannot be opened: %s",
                    configuration.vendor, configuration.product, paths.front().c_str());
    return out;
}

}  // namespace frm::spidar_g
