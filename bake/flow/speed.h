// How fast the solver runs on this machine, beside what its memory allows.
#pragma once

namespace frm::bake {

struct FlowSpeed {
    double bandwidth = 0;  ///< GB/s of a loop that reads and writes one large array in place
    double roof = 0;       ///< million cell updates a second that this allows: 2 * 19 * 4 = 152 bytes a cell
    double kernel = 0;     ///< million cell updates a second in the interior of one large block
    double nested = 0;     ///< the same of a whole run: nested blocks, walls, forces, exchange between blocks
};

/// Takes some `seconds` for each of the three, and 1.3 GB. threads as FlowCase::threads.
FlowSpeed measure_flow_speed(double seconds, int threads);

}  // namespace frm::bake
