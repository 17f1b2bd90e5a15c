// The devices that the program can open by name. A driver joins with one line in device_sources.cpp.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "cli/frm_object.h"

namespace frm::cli {

struct DeviceSource {
    const char* name;
    const char* argument;  ///< what follows the name after a colon; empty: nothing does; in brackets: what may
    const char* what;
    std::function<std::vector<frm_device_info>(const Session&, const std::string& argument)> list;
    std::function<frm_device(const Session&, const std::string& argument, std::uint32_t index)> open;
};

const std::vector<DeviceSource>& device_sources();

/// Of "name" or "name:argument". Throws Failure naming what is wrong.
std::vector<frm_device_info> list_devices(const Session& session, const std::string& name);
frm_device open_device(const Session& session, const std::string& name, std::uint32_t index);

/// Whether the text before the colon, or all of it, is a driver's name.
bool is_device_name(const std::string& text);
/// Throws Failure if `output` is the file that the name names.
void require_other_file(const std::string& output, const std::string& name);

}  // namespace frm::cli
