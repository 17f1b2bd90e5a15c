#include "device/spidar_g/driver.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "core/error.h"
#include "device/simulated/simulated_transport.h"
#ifdef FRM_HAVE_LIBUSB
#include "device/spidar_g/usb_transport.h"
#endif
#ifdef FRM_HAVE_HIDAPI
#include "device/spidar_g/hid_transport.h"
#endif

namespace frm::spidar_g {
namespace {

/// The device's axes are y up, right-handed; the host's are its own. Positions and vectors are carried over, and so is
/// the axis of a rotation: with the grip at the centre, unturned, every host sees no rotation.
class Frames {
public:
    explicit Frames(std::uint32_t host) : device_(FRM_AXES_Y_UP_RIGHT), host_(host) {}

    GripWrench wrench_in(const frm_wrench& w) const {
        const Vec3f f = host_.vector_in(w.force), t = host_.axial_in(w.torque);
        return {Vec3d(plain(device_.vector_out(f))), Vec3d(plain(device_.axial_out(t)))};
    }
    frm_vec3 vector_out(const Vec3d& v) const { return host_.vector_out(device_.vector_in(to_float(v))); }
    frm_vec3 axial_out(const Vec3d& v) const { return host_.axial_out(device_.axial_in(to_float(v))); }
    frm_pose pose_out(const GripPose& p) const {
        const frm_vec3 axis = axial_out({p.rotation.x, p.rotation.y, p.rotation.z});
        return {host_.position_out(device_.position_in({p.position.x, p.position.y, p.position.z})),
                {axis.x, axis.y, axis.z, static_cast<float>(p.rotation.w)}};
    }

private:
    static Vec3f plain(const frm_vec3& v) { return {v.x, v.y, v.z}; }
    static frm_vec3 to_float(const Vec3d& v) {
        return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
    }

    api::Axes device_, host_;
};

/// One call at a time: device/device.cpp sees to it, and the safety layer and its watchdog stand there.
struct Instance {
    std::unique_ptr<SpidarG> device;
    Frames frames;
    std::uint64_t exchanges = 0;
};

Instance& of(void* instance) { return *static_cast<Instance*>(instance); }

std::vector<std::unique_ptr<Transport>> transports(const Configuration& c) {
    if (c.bus == BusKind::usb) {
#ifdef FRM_HAVE_LIBUSB
        return open_usb(c);
#else
        throw Error(FRM_ERROR_UNSUPPORTED, "this libfrm was built without libusb (FRM_WITH_LIBUSB)");
#endif
    }
#ifdef FRM_HAVE_HIDAPI
    return open_hid(c);
#else
    throw Error(FRM_ERROR_UNSUPPORTED, "this libfrm was built without hidapi (FRM_WITH_HIDAPI)");
#endif
}

/// All that answer.
std::vector<std::unique_ptr<SpidarG>> find_all(const Configuration& c) {
    std::vector<std::unique_ptr<SpidarG>> out;
    for (auto& transport : transports(c)) {
        auto device = std::make_unique<SpidarG>(c, std::move(transport));
        if (device->begin()) out.push_back(std::move(device));
    }
    return out;
}

std::unique_ptr<SpidarG> find_one(const Configuration& c, std::int32_t rotary) {
    auto all = find_all(c);
    for (auto& device : all)
        if (rotary < 0 || device->rotary_id() == static_cast<std::uint32_t>(rotary)) return std::move(device);
    if (all.empty())
        throw Error(FRM_ERROR_DEVICE, "no SPIDAR-G (%s %04x:%04x) answers", c.bus == BusKind::usb ? "USB" : "HID",
                    c.vendor, c.product);
    throw Error(FRM_ERROR_DEVICE, "none of the %zu SPIDAR-G that answer has its rotary switch at %d", all.size(),
                rotary);
}

void describe(const SpidarG& device, frm_device_info& info) {
    const Configuration& c = device.configuration();
    info.serial = device.rotary_id();
    info.max_force = static_cast<float>(c.range.force);
    info.max_torque = static_cast<float>(c.range.torque);
    info.period_ns = c.period_ns;
    std::memset(info.name, 0, sizeof info.name);
    std::strncpy(info.name, c.name.c_str(), sizeof info.name - 1);
    if (!device.transport().runs_by_itself())
        std::strncat(info.name, " (simulated)", sizeof info.name - 1 - c.name.size());
}

// Devices are opened and listed by the library's own caller, so that errors keep their text.
frm_status FRM_CALL enumerate(void* user, frm_device_info* list, std::uint32_t capacity, std::uint32_t* count) {
    const Source& source = *static_cast<const Source*>(user);
    const auto all = find_all(load_configuration(source.configuration));
    *count = static_cast<std::uint32_t>(all.size());
    for (std::size_t i = 0; list && i < all.size() && i < capacity; ++i) describe(*all[i], list[i]);
    return FRM_OK;
}

frm_status FRM_CALL open(void* user, std::uint32_t, void** instance) {
    const Source& source = *static_cast<const Source*>(user);
    const Configuration c = load_configuration(source.configuration);
    std::unique_ptr<SpidarG> device;
    if (source.simulated) {
        auto transport = std::make_unique<simulated::SimulatedTransport>(c);
        if (source.simulation) *source.simulation = transport.get();
        device = std::make_unique<SpidarG>(c, std::move(transport));
        device->begin();
    } else {
        device = find_one(c, source.rotary);
    }
    *instance = new Instance{std::move(device), Frames(source.axes), 0};
    return FRM_OK;
}

frm_status FRM_CALL close(void*, void* instance) {
    delete static_cast<Instance*>(instance);
    return FRM_OK;
}

frm_status FRM_CALL info(void*, void* instance, frm_device_info* out) {
    describe(*of(instance).device, *out);
    return FRM_OK;
}

frm_status FRM_CALL calibrate(void*, void* instance) {
    return of(instance).device->calibrate() ? FRM_OK : FRM_ERROR_DEVICE;
}

frm_status FRM_CALL exchange(void*, void* instance, const frm_device_command* command, frm_device_state* state) {
    Instance& i = of(instance);
    const GripState grip = i.device->exchange(i.frames.wrench_in(command->wrench));
    state->pose = i.frames.pose_out(grip.pose);
    state->twist = {i.frames.vector_out(grip.twist.linear), i.frames.axial_out(grip.twist.angular)};
    state->achieved = {i.frames.vector_out(grip.achieved.force), i.frames.axial_out(grip.achieved.torque)};
    state->buttons = grip.buttons;
    state->faults = grip.faults;
    state->status = grip.faults & ~static_cast<std::uint32_t>(FRM_DEVICE_FAULT_UNCALIBRATED) ? FRM_DEVICE_FAULT
                    : grip.faults & FRM_DEVICE_FAULT_UNCALIBRATED                            ? FRM_DEVICE_UNCALIBRATED
                                                                                             : FRM_DEVICE_READY;
    state->time_ns = grip.time_ns;
    state->sequence = i.exchanges++;
    return FRM_OK;
}

frm_status FRM_CALL raw(void*, void* instance, std::uint8_t* data, std::uint32_t capacity, std::uint32_t* size) {
    const Packet& reply = of(instance).device->last_reply();
    std::copy_n(reply.bytes.begin(), std::min<std::size_t>(reply.size, capacity), data);
    *size = static_cast<std::uint32_t>(reply.size);
    return FRM_OK;
}

frm_status FRM_CALL stop(void*, void* instance) {
    of(instance).device->stop();
    return FRM_OK;
}

}  // namespace

const frm_device_driver& driver() {
    static const frm_device_driver table{
        sizeof(frm_device_driver), 0, enumerate, open, close, info, calibrate, exchange, stop, raw};
    return table;
}

}  // namespace frm::spidar_g
