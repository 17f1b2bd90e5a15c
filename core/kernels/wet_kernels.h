// What the kernels of the wet surface and of the displaced volume take. Plain data: this header has no functions, since
// kernels are compiled for several instruction sets (set.inl). Arrays of sixteen are the kernels' logical width.
#pragma once

#include <cstddef>
#include <cstdint>

namespace frm {

constexpr std::size_t kernel_lanes = 16;
constexpr std::size_t kernel_longest_row = 272;  ///< half of the largest window, and two

/// Begins on a cache line; kernels take T itself.
template <typename T>
struct alignas(64) OnLines : T {};

/// Sixteen triangles: corners, outward vector area, area.
struct TriangleBatch {
    float x[3][kernel_lanes], y[3][kernel_lanes], z[3][kernel_lanes];
    float normal[3][kernel_lanes];
    float area[kernel_lanes];
};

/// What integrates a depth that is linear over a surface, depth(X) = b + a . (X - c) with c the area's centroid:
///   sum over the surface of depth n dA and of depth X x n dA = b even + a.x slope[0] + a.y slope[1] + a.z slope[2].
/// Each of the four is three components of the first (force) and three of the second (torque).
struct WetMoments {
    float moment[4][6];  ///< even, slope x, y, z
    float centroid[3];
    float area;
};

/// Sixteen clusters: moments as above, and where to sample the water. Along its first two principal axes a cluster is
/// sampled at `point`, centroid +- r axis: with r = sqrt(2) times the area's standard deviation along the axis the mean of
/// the four is the mean over the cluster of any height of second degree.
struct ClusterBlock {
    float moment[4][6][kernel_lanes];
    float centroid[3][kernel_lanes];
    float area[kernel_lanes];
    float axis[3][3][kernel_lanes];   ///< principal axes of the area, unit length
    float extent[3][kernel_lanes];    ///< farthest corner from the centroid along each
    float per_span[2][kernel_lanes];  ///< 1 / (2 r); 0 where r is 0
    float point[3][4][kernel_lanes];  ///< x, y, z of centroid + r0 axis0, - r0, + r1 axis1, - r1
};

/// Heights of the water at cell centres.
struct HeightGrid {
    const float* height;
    std::ptrdiff_t stride;  ///< from row to row
    std::int32_t nx, ny;
    float level;  ///< to be added to all of them
};

/// Where a body's centre lies over a grid: cell (i, j) plus (x, y) cells; and how many cells (and metres up, in the map's
/// lengths) a step along each of the body's axes is.
struct GridPlacement {
    std::int32_t i, j;
    float x, y;
    float along_x[3], along_y[3];
};

/// The water's surface for a body in the map's lengths: calm surface `level` above the centre, `up` the world's z axis in
/// the body's frame, `per_metre` the map's lengths in a metre.
struct BodyLevel {
    float level;
    float up[3];
    float per_metre;
};

enum : std::uint8_t { cluster_dry = 0, cluster_cut = 1, cluster_wet = 2 };

/// The surface over sixteen clusters: depth(X) = offset + slope . X, X from the body's centre, and how each lies to it.
struct ClusterPlanes {
    float offset[kernel_lanes];
    float slope[3][kernel_lanes];
    std::int32_t state[kernel_lanes];
};

/// Sums over the wet surface in sixteen lanes: force and torque about the centre (integrals of depth n and X x n depth),
/// area, and integral of depth.
struct WetLanes {
    float force[3][kernel_lanes], torque[3][kernel_lanes];
    float area[kernel_lanes], depth[kernel_lanes];
};

/// Sixteen elements of a body's volume: centroid, volume, and three times the variance along each of the body's axes (the
/// square of half an edge, for a box).
struct ElementBlock {
    float x[kernel_lanes], y[kernel_lanes], z[kernel_lanes];
    float volume[kernel_lanes];
    float spread[3][kernel_lanes];
};

/// One level of grids (pyramid.h) to lay slices of a body's columns on: those as wide as asked for by their depth.
struct SliceLevel {
    float cell;    ///< of this level, in cells of the water
    float widest;  ///< 1: nothing coarser, what is wider is weakened and left to all of the water
    float finest;  ///< 1: nothing finer, takes all that is narrower
    float spread;  ///< 0: takes all, whatever its depth
    float width;   ///< cells of width for each of the map's lengths of depth
};

}  // namespace frm
