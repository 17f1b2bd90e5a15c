#include "cli/device_sources.h"

#include <algorithm>
#include <cstdlib>

#include "cli/command.h"
#include "cli/file.h"

namespace frm::cli {
namespace {

frm_device_info info_of(const Session& session, frm_device device) {
    frm_device_info info{};
    info.struct_size = sizeof info;
    session.check(frm_device_get_info(device, &info));
    return info;
}

frm_device open_null(const Session& session, const std::string&, std::uint32_t index) {
    if (index != 0) throw Failure("null: there is one device, number 0");
    frm_device device = 0;
    session.check(frm_device_open_null(session.context(), &device));
    return device;
}

std::vector<frm_device_info> list_null(const Session& session, const std::string&) {
    const frm_device device = open_null(session, "", 0);
    const frm_device_info info = info_of(session, device);
    session.check(frm_device_close(device));
    return {info};
}

frm_device open_replay(const Session& session, const std::string& file, std::uint32_t index) {
    frm_device device = 0;
    session.check(frm_device_open_replay(session.context(), file.c_str(), index, &device));
    return device;
}

std::vector<frm_device_info> list_replay(const Session& session, const std::string& file) {
    std::vector<frm_device_info> list;
    frm_replay replay = 0;
    frm_replay_info info{};
    info.struct_size = sizeof info;
    session.check(frm_replay_open(session.context(), file.c_str(), &replay));
    session.check(frm_replay_get_info(replay, &info));
    session.check(frm_replay_close(replay));
    for (std::uint32_t i = 0; i < info.devices; ++i) {
        const frm_device device = open_replay(session, file, i);
        list.push_back(info_of(session, device));
        session.check(frm_device_close(device));
    }
    return list;
}

const char* configuration(const std::string& file) { return file.empty() ? nullptr : file.c_str(); }

frm_device open_simulated(const Session& session, const std::string& file, std::uint32_t index) {
    if (index != 0) throw Failure("sim: there is one device, number 0");
    frm_device device = 0;
    session.check(frm_device_open_simulated(session.context(), configuration(file), &device));
    return device;
}

std::vector<frm_device_info> list_simulated(const Session& session, const std::string& file) {
    const frm_device device = open_simulated(session, file, 0);
    const frm_device_info info = info_of(session, device);
    session.check(frm_device_close(device));
    return {info};
}

std::vector<frm_device_info> list_spidar(const Session& session, const std::string& file) {
    std::uint32_t count = 0;
    std::vector<frm_device_info> list(16);  // as many as a rotary switch tells apart
    for (frm_device_info& info : list) info.struct_size = sizeof info;
    session.check(frm_device_enumerate_spidar_g(session.context(), configuration(file), list.data(),
                                                static_cast<std::uint32_t>(list.size()), &count));
    list.resize(std::min<std::size_t>(count, list.size()));
    return list;
}

frm_device open_spidar(const Session& session, const std::string& file, std::uint32_t index) {
    std::int32_t rotary = -1;
    if (index > 0) {
        const std::vector<frm_device_info> list = list_spidar(session, file);
        if (index >= list.size())
            throw Failure("spidar: there is no device " + std::to_string(index) + "; " + std::to_string(list.size()) +
                          " answer");
        rotary = static_cast<std::int32_t>(list[index].serial);
    }
    frm_device device = 0;
    session.check(frm_device_open_spidar_g(session.context(), configuration(file), rotary, &device));
    return device;
}

/// The source and the argument.
std::pair<const DeviceSource*, std::string> find(const std::string& name) {
    const std::size_t colon = name.find(':');
    const std::string before = name.substr(0, colon), after = colon == std::string::npos ? "" : name.substr(colon + 1);
    std::string known;
    for (const DeviceSource& source : device_sources()) {
        if (before == source.name) {
            if (*source.argument && *source.argument != '[' && after.empty())
                throw Failure(name + ": " + source.argument + " is needed: " + source.name + ":" + source.argument);
            if (!*source.argument && colon != std::string::npos)
                throw Failure(name + ": " + source.name + " takes nothing after a colon");
            return {&source, after};
        }
        known += std::string(known.empty() ? "" : ", ") + source.name +
                 (*source.argument && *source.argument != '[' ? ":" : "") + source.argument;
    }
    throw Failure(name + ": there is no such driver; there are " + known);
}

}  // namespace

const std::vector<DeviceSource>& device_sources() {
    static const std::vector<DeviceSource> sources{
        {"null", "", "a device that is not there: it rests at the origin", list_null, open_null},
        {"replay", "FILE", "the devices of a recording, moving as they did", list_replay, open_replay},
        {"sim", "[:CONFIGURATION]", "a simulated SPIDAR-G, held by a simulated hand", list_simulated, open_simulated},
        {"spidar", "[:CONFIGURATION]", "SPIDAR-G by libusb or hidapi; not yet run on hardware", list_spidar,
         open_spidar},
    };
    return sources;
}

std::vector<frm_device_info> list_devices(const Session& session, const std::string& name) {
    const auto [source, argument] = find(name);
    return source->list(session, argument);
}

frm_device open_device(const Session& session, const std::string& name, std::uint32_t index) {
    const auto [source, argument] = find(name);
    return source->open(session, argument, index);
}

bool is_device_name(const std::string& text) {
    const std::string before = text.substr(0, text.find(':'));
    return std::any_of(device_sources().begin(), device_sources().end(),
                       [&](const DeviceSource& source) { return before == source.name; });
}

void require_other_file(const std::string& output, const std::string& name) {
    const std::size_t colon = name.find(':');
    if (colon != std::string::npos) require_distinct({output}, {name.substr(colon + 1)});
}

}  // namespace frm::cli
