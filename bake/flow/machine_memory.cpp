#include "bake/flow/machine_memory.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace frm::bake {
namespace {

constexpr std::uint64_t where_unknown = std::uint64_t{8} << 30;

std::uint64_t physical() {
    const long pages = sysconf(_SC_PHYS_PAGES), size = sysconf(_SC_PAGESIZE);
    return pages > 0 && size > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(size) : 0;
}

/// 0 where there is none: the file says "max" or is not there.
std::uint64_t limit_of_container() {
    std::ifstream file("/sys/fs/cgroup/memory.max");
    std::uint64_t bytes = 0;
    return file >> bytes ? bytes : 0;
}

std::uint64_t measure_usable() {
    const std::uint64_t machine = physical(), container = limit_of_container();
    if (machine == 0 && container == 0) return where_unknown;
    const std::uint64_t all = machine == 0 ? container : container == 0 ? machine : std::min(machine, container);
    return all / 4 * 3;
}

}  // namespace

// Asked for with every flow that is planned.
std::uint64_t usable_memory() {
    static const std::uint64_t bytes = measure_usable();
    return bytes;
}

}  // namespace frm::bake
