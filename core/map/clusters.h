// The surface of a map in clusters of triangles that lie close together and face alike. A cluster that is wholly under a
// flat water surface costs one evaluation of its moments; one that the surface cuts is clipped triangle by triangle,
// sixteen at a time. Lengths are the map's, positions count from `centre`.
#pragma once

#include <cstdint>
#include <memory_resource>
#include <vector>

#include "core/kernels/wet_kernels.h"
#include "core/math/vec.h"

namespace frm {

struct Map;

struct Clusters {
    static constexpr std::uint32_t capacity = 2 * kernel_lanes;  ///< triangles of a cluster, at most

    explicit Clusters(std::pmr::memory_resource* memory)
        : batches(memory), first_batch(memory), blocks(memory), region_begin(memory) {}

    /// From a map whose triangles and regions have been checked.
    void build(const Map& map);

    std::uint32_t count() const { return static_cast<std::uint32_t>(first_batch.size() - 1); }

    Vec3f centre;      ///< of the box around the surface, body frame
    Vec3f half;        ///< half of that box
    float radius = 0;  ///< of a sphere around `centre` that holds the surface
    Vec3f sampled;     ///< half of a box around `centre` that holds the surface and where its clusters sample the water
    /// How far beyond its four samples a cluster's plane may lie somewhere on the cluster, at most: a share of the difference
    /// between the largest and the smallest of them.
    float overshoot = 0;
    std::pmr::vector<OnLines<TriangleBatch>>
        batches;                                  ///< the triangles; the last of a cluster is filled up with empty ones
    std::pmr::vector<std::uint32_t> first_batch;  ///< [clusters + 1]
    std::pmr::vector<OnLines<ClusterBlock>> blocks;  ///< sixteen clusters each; the last is filled up with empty ones
    std::pmr::vector<std::uint32_t> region_begin;    ///< [sources + 1]: clusters of region l start here
    WetMoments whole;                                ///< of all of the surface
};

}  // namespace frm
