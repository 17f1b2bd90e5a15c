// How long something kept the processor: what a bound is held against on a machine that others use too.
#pragma once

#include <ctime>

namespace frm::test {

/// Seconds of all of the program's threads.
template <typename Work>
double processor_seconds(const Work& work) {
    const std::clock_t begin = std::clock();
    work();
    return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

}  // namespace frm::test
