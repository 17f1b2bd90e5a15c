// The C entry points of devices, recorders and replays.
#include <cstring>

#include "device/device.h"
#include "device/recorder.h"
#include "device/replay.h"
#include "device/spidar_g/driver.h"

using namespace frm;
using namespace frm::api;
using frm::device::Device;
using frm::device::Recorder;
using frm::device::Replay;

namespace {

frm_recorder_def default_recorder() {
    frm_recorder_def def{};
    const device::RecorderDef defaults;
    def.hash_interval = defaults.hash_interval;
    def.force_interval = defaults.force_interval;
    def.queue_bytes = defaults.queue_bytes;
    return def;
}

}  // namespace

frm_status FRM_CALL frm_device_enumerate(frm_context context, const frm_device_driver* driver, void* user,
                                         frm_device_info* list, uint32_t capacity, uint32_t* count) {
    return with_context(context, [&](Context&) {
        require_pointer(count, "count");
        const frm_device_driver d = device::checked_driver(driver);
        std::uint32_t seen = 0;
        const frm_status status = d.enumerate(user, list, capacity, &seen);
        if (status != FRM_OK)
            throw Error(FRM_ERROR_DEVICE, "the device's driver failed in enumerate: %s", frm_status_name(status));
        *count = seen;
    });
}

frm_status FRM_CALL frm_device_open(frm_context context, const frm_device_driver* driver, void* user, uint32_t index,
                                    frm_device* device) {
    return with_context(context, [&](Context& c) {
        require_pointer(device, "device");
        *device = c.add(Kind::device, c.make<Device>(device::checked_driver(driver), user, index));
    });
}

frm_status FRM_CALL frm_device_open_null(frm_context context, frm_device* device) {
    return frm_device_open(context, &device::null_driver(), nullptr, 0, device);
}

frm_status FRM_CALL frm_device_open_replay(frm_context context, const char* path, uint32_t index, frm_device* device) {
    return with_context(context, [&](Context& c) {
        require_pointer(path, "path");
        require_pointer(device, "device");
        device::ReplaySource source{path, index, c.axes().host()};
        *device = c.add(Kind::device, c.make<Device>(device::replay_driver(), &source, 0u));
    });
}

frm_status FRM_CALL frm_device_enumerate_spidar_g(frm_context context, const char* configuration, frm_device_info* list,
                                                  uint32_t capacity, uint32_t* count) {
    return with_context(context, [&](Context& c) {
        require_pointer(count, "count");
        spidar_g::Source source{configuration, -1, c.axes().host(), false};
        std::uint32_t seen = 0;
        spidar_g::driver().enumerate(&source, list, capacity, &seen);
        *count = seen;
    });
}

frm_status FRM_CALL frm_device_open_spidar_g(frm_context context, const char* configuration, int32_t rotary,
                                             frm_device* device) {
    return with_context(context, [&](Context& c) {
        require_pointer(device, "device");
        if (rotary < -1 || rotary > 15)
            throw Error(FRM_ERROR_ARGUMENT, "rotary is %d; it is 0 to 15, or -1 for any", rotary);
        spidar_g::Source source{configuration, rotary, c.axes().host(), false};
        // Kept: its counters wrap.
        *device = c.add(Kind::device, c.make<Device>(spidar_g::driver(), &source, 0u, true));
    });
}

frm_status FRM_CALL frm_device_open_simulated(frm_context context, const char* configuration, frm_device* device) {
    return with_context(context, [&](Context& c) {
        require_pointer(device, "device");
        spidar_g::Source source{configuration, -1, c.axes().host(), true};
        *device = c.add(Kind::device, c.make<Device>(spidar_g::driver(), &source, 0u));
    });
}

frm_status FRM_CALL frm_device_close(frm_device device) {
    return with<Device>(device, [&](Context& c, Device& object) {
        if (object.servos > 0) throw Error(FRM_ERROR_STATE, "a servo uses this device: destroy it first");
        c.remove(device);
    });
}

frm_status FRM_CALL frm_device_get_info(frm_device device, frm_device_info* info) {
    return with<Device>(device, [&](Context&, Device& object) {
        require_out(info, "info");
        device::require_not_served(object);
        write_struct(info, object.info());
    });
}

frm_status FRM_CALL frm_device_calibrate(frm_device device) {
    return with<Device>(device, [&](Context&, Device& object) {
        device::require_not_served(object);
        object.calibrate();
    });
}

frm_status FRM_CALL frm_device_exchange(frm_device device, const frm_device_command* command, frm_device_state* state) {
    return with<Device>(device, [&](Context& c, Device& object) {
        require_out(state, "state");
        const frm_device_command checked = read_def(command, frm_device_command{}, "command");
        device::require_not_served(object);
        write_struct(state, object.exchange(c.axes(), checked));
    });
}

frm_status FRM_CALL frm_device_get_raw(frm_device device, uint8_t* data, uint32_t capacity, uint32_t* size) {
    return with<Device>(device, [&](Context&, Device& object) {
        require_pointer(size, "size");
        device::require_not_served(object);
        std::uint8_t packet[device::largest_packet];
        const auto length = static_cast<std::uint32_t>(object.raw(packet, sizeof packet));
        *size = length;
        if (!data) return;
        if (capacity < length)
            throw Error(FRM_ERROR_CAPACITY, "the buffer takes %u bytes; %u are needed", capacity, length);
        std::memcpy(data, packet, length);
    });
}

frm_status FRM_CALL frm_device_stop(frm_device device) {
    return with<Device>(device, [&](Context&, Device& object) {
        device::require_not_served(object);
        object.stop();
    });
}

frm_status FRM_CALL frm_recorder_def_init(frm_recorder_def* def, uint64_t size) {
    return init_def(def, size, default_recorder());
}

frm_status FRM_CALL frm_recorder_create(frm_world world, const char* path, const frm_recorder_def* def,
                                        frm_recorder* recorder) {
    return with<WorldObject>(world, [&](Context& c, WorldObject& object) {
        require_pointer(path, "path");
        require_pointer(recorder, "recorder");
        require_changeable(object);
        const frm_recorder_def d = read_def(def, default_recorder(), "def");
        require_range(d.hash_interval, 1, 1e6, "def.hash_interval");
        require_range(d.queue_bytes, 1 << 16, 1 << 30, "def.queue_bytes");
        if (d.waits > 1) throw Error(FRM_ERROR_ARGUMENT, "def.waits = %u is not 0 or 1", d.waits);
        require_range(d.force_interval, 1, 1e6, "def.force_interval");
        if (object.world.observer()) throw Error(FRM_ERROR_STATE, "this world has a recorder already");
        if (object.world.ticks() > 0)
            throw Error(FRM_ERROR_STATE, "this world has ticked already: a recording begins with its world");
        const device::RecorderDef checked{d.hash_interval, d.force_interval, d.queue_bytes, d.waits != 0};
        *recorder = c.add(Kind::recorder, c.make<Recorder>(object, path, checked, c.axes().host()));
    });
}

frm_status FRM_CALL frm_recorder_add_device(frm_recorder recorder, frm_device device) {
    return with<Recorder>(recorder, [&](Context& c, Recorder& object) {
        require_not_served(object.world());
        Object* found = c.find(device, Kind::device);
        if (!found) throw Error(FRM_ERROR_HANDLE, "this is not a device of this context, or it is no more");
        device::require_not_served(static_cast<Device&>(*found));
        object.add_device(static_cast<Device&>(*found));
    });
}

frm_status FRM_CALL frm_recorder_get_stats(frm_recorder recorder, frm_recorder_stats* stats) {
    return with<Recorder>(recorder, [&](Context&, Recorder& object) {
        require_out(stats, "stats");
        write_struct(stats, object.stats());
    });
}

frm_status FRM_CALL frm_recorder_close(frm_recorder recorder) {
    return with<Recorder>(recorder, [&](Context& c, Recorder& object) {
        require_not_served(object.world());
        try {
            object.close();
        } catch (...) {
            c.remove(recorder);
            throw;
        }
        c.remove(recorder);
    });
}

frm_status FRM_CALL frm_replay_open(frm_context context, const char* path, frm_replay* replay) {
    return with_context(context, [&](Context& c) {
        require_pointer(path, "path");
        require_pointer(replay, "replay");
        *replay = c.add(Kind::replay, c.make<Replay>(c, path));
    });
}

frm_status FRM_CALL frm_replay_close(frm_replay replay) {
    return with<Replay>(replay, [&](Context& c, Replay&) { c.remove(replay); });
}

frm_status FRM_CALL frm_replay_get_info(frm_replay replay, frm_replay_info* info) {
    return with<Replay>(replay, [&](Context&, Replay& object) {
        require_out(info, "info");
        write_struct(info, object.info());
    });
}

frm_status FRM_CALL frm_replay_set_tolerance(frm_replay replay, const frm_replay_tolerance* tolerance) {
    return with<Replay>(replay, [&](Context&, Replay& object) {
        const frm_replay_tolerance t = read_def(tolerance, frm_replay_tolerance{}, "tolerance");
        require_range(static_cast<double>(t.relative), 0, 1, "tolerance.relative");
        require_range(static_cast<double>(t.force), 0, 1e9, "tolerance.force");
        require_range(static_cast<double>(t.torque), 0, 1e9, "tolerance.torque");
        object.set_tolerance(t);
    });
}

frm_status FRM_CALL frm_replay_step(frm_replay replay, frm_replay_step_result* result) {
    return with<Replay>(replay, [&](Context&, Replay& object) {
        require_out(result, "result");
        write_struct(result, object.step());
    });
}

frm_status FRM_CALL frm_replay_get_world(frm_replay replay, frm_world* world) {
    return with<Replay>(replay, [&](Context&, Replay& object) {
        require_pointer(world, "world");
        *world = object.world();
    });
}

frm_status FRM_CALL frm_replay_get_water(frm_replay replay, frm_water* water) {
    return with<Replay>(replay, [&](Context&, Replay& object) {
        require_pointer(water, "water");
        if (object.water() == 0) throw Error(FRM_ERROR_STATE, "there is no water at this point of the recording");
        *water = object.water();
    });
}

frm_status FRM_CALL frm_replay_get_body(frm_replay replay, uint32_t index, frm_body* body) {
    return with<Replay>(replay, [&](Context&, Replay& object) {
        require_pointer(body, "body");
        if (object.body(index) == 0)
            throw Error(FRM_ERROR_STATE, "there is no body %u at this point of the recording", index);
        *body = object.body(index);
    });
}

frm_status FRM_CALL frm_replay_get_map(frm_replay replay, uint32_t index, frm_map* map) {
    return with<Replay>(replay, [&](Context&, Replay& object) {
        require_pointer(map, "map");
        if (object.map(index) == 0)
            throw Error(FRM_ERROR_ARGUMENT, "index: there is no map %u at this point of the recording", index);
        *map = object.map(index);
    });
}
