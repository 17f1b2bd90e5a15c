// The tensions that display a wrench: the nearest one that strings can, which only pull, and only so much.
#pragma once

#include "device/spidar_g/geometry.h"

namespace frm::spidar_g {

struct TensionLimits {
    Tensions low, high;  ///< N, 0 <= low < high
};

struct TensionResult {
    Tensions tensions;  ///< always within the limits
    int iterations = 0;
    bool optimal = false;  ///< else the iterations ran out: the best so far
};

/// Never more iterations than this. A cold start takes about a dozen, a 1 kHz loop one or two.
constexpr int tension_iterations = 40;

/// Minimises |W t - w|^2 + e |t|^2 within the limits; forces in N, torques over the lever, so that both count alike.
/// The second term picks the lowest of the tensions that give the same wrench, and is too small to be felt (e is 1e-6).
/// A primal active-set method: every iterate is within the limits and no worse than the one before it. It keeps the set
/// of strings that are at a limit from call to call.
class TensionSolver {
public:
    explicit TensionSolver(const TensionLimits& limits);

    /// All strings at their lowest tension if `rows` or the wrench are not numbers.
    TensionResult solve(const StringRows& rows, const GripWrench& wrench, double lever);

    /// Forgets the last call.
    void reset();

private:
    enum class At : unsigned char { low, high, free };

    TensionLimits limits_;
    At at_[string_count];
    Tensions last_;
};

}  // namespace frm::spidar_g
