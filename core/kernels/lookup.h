// What the kernels of the lookup (Eq. 6) read and write: plain arrays, without a function.
#pragma once

#include <cstddef>
#include <cstdint>

namespace frm {

/// Pressure x, y, z, 0, friction x, y, z, 0: half a cache line.
struct alignas(32) ForceRow {
    float v[8];
};

/// The same order, in steps of the direction.
struct alignas(16) SwingRow {
    std::int16_t v[8];
};

/// How much of its strength a blend of the three fluctuations of a face keeps: of the force on the whole object, in any
/// common unit.
struct FaceLevel {
    float rms[3];      ///< of each corner's
    float product[3];  ///< mean product of corners 1 and 2, 2 and 0, 0 and 1
};

/// The three directions at a face's corners, by number.
struct FaceCorners {
    std::uint32_t index[3];
};

/// A map laid out for a tick. One sample of one source is one cache line or less.
struct LookupTable {
    static constexpr std::size_t max_speeds = 16;

    std::uint32_t sources = 0, samples = 0, speeds = 0;
    std::uint32_t base = 0;  ///< the base speed's number
    std::int32_t frequency = 1, swing_frequency = 1;
    bool one_set = false;      ///< means and fluctuations share their directions
    const float* x = nullptr;  ///< [sources, rounded up to whole blocks], of the sources, m
    const float *y = nullptr, *z = nullptr;
    const FaceCorners *corners = nullptr, *swing_corners = nullptr;  ///< [face]
    const ForceRow* mean = nullptr;                                  ///< [speed][direction][source], N
    /// Of groups of sources: from a row of `mean` to its torque about the group's centre, N m; from one of `spin`. Else 0.
    std::ptrdiff_t torque = 0, spin_torque = 0;
    const SwingRow* swing = nullptr;           ///< [direction][source][samples + 1]: the first sample again at the end
    const float* step = nullptr;               ///< [direction], N: one unit of `swing`
    const FaceLevel* level = nullptr;          ///< [face]
    const ForceRow* spin = nullptr;            ///< [6][source]; null: there is no table
    const std::uint8_t* steady = nullptr;      ///< [source]: 1 where the fluctuation does not count
    float period = 0, samples_per_second = 0;  ///< of map time
    float log_speed[max_speeds] = {};
    float per_log[max_speeds] = {};  ///< 1 / (log_speed[k + 1] - log_speed[k])
};

/// The motion of a body for all its sources, body frame, and the similarity laws.
struct LookupMotion {
    float velocity[3];     ///< m/s
    float rotation[3];     ///< rad/s, times the body's scale: times a position of the map it is a velocity
    float per_base_speed;  ///< 1 / u0
    float time;            ///< s of map time that pass for each u / u0
    float pressure, friction;
    float reynolds_speed;  ///< m/s of the map for each m/s here, for the same Reynolds number
    float spin_pressure, spin_friction, spin_weight[3];
    std::uint32_t spin_axis[3];
    bool by_speed;       ///< means follow the Reynolds number; else the base speed's
    bool keep_level;     ///< a blend of fluctuations is as strong as its parts
    bool swinging;       ///< fluctuations are looked up at all
    bool skip_steady;    ///< not those of steady sources
    bool skip_friction;  ///< the friction half of all rows is left out and comes out as zero
    bool spinning;       ///< spin_* are filled
};

constexpr std::size_t lookup_block = 16;

/// Sixteen sources of a body at a time.
struct alignas(64) LookupBlock {
    // In.
    float wet[lookup_block];                                  ///< wet ratio; 0 beyond the last source
    float x[lookup_block], y[lookup_block], z[lookup_block];  ///< in: the water's velocity; out: the stream; body frame
    // In and out.
    float time[lookup_block];  ///< map time, s
    // Out.
    float speed[lookup_block];  ///< of the stream, m/s
    ForceRow force[lookup_block];
    // In.
    std::uint32_t count = 0;  ///< of sources, 16 at most
};

/// Sums over the sources: of the force, and of each component of the position (as in the map) times the force.
struct LookupSum {
    ForceRow force, x, y, z;
    ForceRow torque;  ///< of the groups, each about its centre
};

}  // namespace frm
