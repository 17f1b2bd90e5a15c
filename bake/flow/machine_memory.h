// How much memory a run may take where nobody says.
#pragma once

#include <cstdint>

namespace frm::bake {

/// Bytes: three quarters of what the machine has, or of what its container may have where that is less (Linux, cgroup 2);
/// 8 GiB where neither is known. The rest is for the mesh, the map and whoever else is there.
std::uint64_t usable_memory();

}  // namespace frm::bake
