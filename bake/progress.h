// How a long computation tells what it is doing, and learns that it should stop.
#pragma once

#include <functional>
#include <string>

namespace frm::bake {

/// Called a few times a second with the share done, 0 to 1, and a short note ("drag 1.09").
/// Returning false asks the computation to stop; it then throws Cancelled.
using Progress = std::function<bool(double share, const std::string& note)>;

}  // namespace frm::bake
