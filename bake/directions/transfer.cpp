#include "bake/directions/transfer.h"

#include <algorithm>
#include <map>

#include "bake/error.h"

namespace frm::bake {
namespace {

constexpr std::size_t enough_triangles = 4000;

std::uint32_t image_of(const Landing& landing, std::size_t triangle, const Vec3d& centre, const Matrix3& g) {
    const Facet& from = landing.facet(triangle);
    return landing.find(centre + g * (from.centre - centre), g * from.normal);
}

}  // namespace

Transfer::Transfer(const Carrier& carrier, const Matrix3& g) : g_(g) {
    const Surface& s = carrier.surface;
    // Of a mesh with more triangles than that every second, third ... of each patch.
    const std::size_t stride = std::max<std::size_t>(1, s.triangles.size() / enough_triangles);
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> parts;
    std::vector<double> whole(carrier.patches.count, 0.0);
    std::vector<std::size_t> seen(carrier.patches.count, 0);
    for (std::size_t t = 0; t < s.triangles.size(); ++t) {
        if (seen[carrier.patches.region[t]]++ % stride) continue;
        const double area = carrier.landing.facet(t).area;
        const std::uint32_t patch = carrier.patches.region[t];
        parts[{patch, carrier.regions.region[image_of(carrier.landing, t, carrier.centre, g)]}] += area;
        whole[patch] += area;
    }
    for (const auto& [pair, area] : parts)
        if (area > 0) shares_.push_back({pair.first, pair.second, area / whole[pair.first]});
}

const Transfer& Transfers::of(const Matrix3& g) {
    for (const Transfer& transfer : known_)
        if (transfer.g().row == g.row) return transfer;
    return known_.emplace_back(carrier_, g);
}

std::vector<PatchForce> Transfers::mean(const std::vector<PatchForce>& patch, const std::vector<Matrix3>& by) {
    std::vector<PatchForce> mean(carrier_.regions.count);
    const double part = 1.0 / static_cast<double>(by.size());
    for (const Matrix3& g : by) {
        for (const Transfer::Share& s : of(g).shares()) {
            mean[s.region].pressure += (g * patch[s.patch].pressure) * (s.share * part);
            mean[s.region].friction += (g * patch[s.patch].friction) * (s.share * part);
        }
    }
    return mean;
}

Regions patches_for(const Surface& surface, const Regions& regions, const std::vector<Matrix3>& elements,
                    const Vec3d& centre, const Landing& landing) {
    if (regions.region.size() != surface.triangles.size()) throw BakeError("directions: regions of another surface");
    Regions result;
    // What a patch is known by: the regions that the elements carry it to.
    std::map<std::vector<std::uint32_t>, std::uint32_t> known;
    std::vector<std::uint32_t> carried(elements.size());
    for (std::uint32_t t = 0; t < surface.triangles.size(); ++t) {
        for (std::size_t e = 0; e < elements.size(); ++e)
            carried[e] = regions.region[image_of(landing, t, centre, elements[e])];
        const auto [patch, added] = known.emplace(carried, result.count);
        result.count += added;
        result.region.push_back(patch->second);
    }
    return result;
}

}  // namespace frm::bake
