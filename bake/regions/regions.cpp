#include "bake/regions/regions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>

#include "bake/mesh/adjacency.h"
#include "bake/regions/patches.h"

namespace frm::bake {

namespace {

// How many regions each shell gets: by area, at least one, never more than its triangles; largest remainders first.
std::vector<std::uint32_t> share_out(const std::vector<double>& area, const std::vector<std::uint32_t>& triangles,
                                     std::uint32_t count) {
    std::vector<std::uint32_t> share(area.size(), 1);
    for (auto left = count - static_cast<std::uint32_t>(area.size()); left > 0; --left) {
        std::size_t neediest = area.size();
        for (std::size_t s = 0; s < area.size(); ++s) {
            if (share[s] == triangles[s]) continue;
            // Area over the next odd number (Sainte-Lague): each region as near to the mean area as whole numbers
            // allow.
            if (neediest == area.size() ||
                area[s] / (2.0 * share[s] + 1) > area[neediest] / (2.0 * share[neediest] + 1))
                neediest = s;
        }
        ++share[neediest];
    }
    return share;
}

// With fewer regions than shells each large shell is a region and each small one joins the nearest of them.
std::vector<std::uint32_t> group_shells(const std::vector<double>& area, const std::vector<Vec3d>& centre,
                                        std::uint32_t count) {
    std::vector<std::uint32_t> by_area(area.size());
    for (std::uint32_t s = 0; s < by_area.size(); ++s) by_area[s] = s;
    std::sort(by_area.begin(), by_area.end(),
              [&](std::uint32_t a, std::uint32_t b) { return area[a] != area[b] ? area[a] > area[b] : a < b; });
    std::vector<std::uint32_t> group(area.size(), 0);
    for (std::uint32_t i = 0; i < by_area.size(); ++i) {
        const std::uint32_t s = by_area[i];
        if (i < count) {
            group[s] = i;
            continue;
        }
        double nearest = HUGE_VAL;
        for (std::uint32_t g = 0; g < count; ++g) {
            const Vec3d d = centre[s] - centre[by_area[g]];
            if (dot(d, d) < nearest) {
                nearest = dot(d, d);
                group[s] = g;
            }
        }
    }
    return group;
}

// Regions in the order of their first triangles: the numbering then does not depend on how they were found.
void renumber(Regions& regions) {
    constexpr auto none = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> number(regions.count, none);
    std::uint32_t next = 0;
    for (std::uint32_t& r : regions.region) {
        if (number[r] == none) number[r] = next++;
        r = number[r];
    }
}

}  // namespace

Regions split_regions(const Surface& surface, std::uint32_t count) {
    if (count < 1 || count > kMostRegions) {
        throw BakeError("regions: " + std::to_string(count) + " haptic sources asked for; 1 to " +
                        std::to_string(kMostRegions) + " are possible");
    }
    if (count > surface.triangles.size()) {
        throw BakeError("regions: " + std::to_string(count) + " haptic sources asked for, but the surface has only " +
                        std::to_string(surface.triangles.size()) +
                        " triangles; ask for fewer sources or for more triangles");
    }
    const Neighbours neighbours = find_neighbours(surface, "regions");
    std::vector<std::uint32_t> shell;
    const std::uint32_t shells = find_shells(neighbours, shell);

    std::vector<Facet> facets;
    std::vector<double> area(shells, 0.0);
    std::vector<Vec3d> centre(shells);
    std::vector<std::vector<std::uint32_t>> members(shells);
    std::vector<std::uint32_t> place(shell.size());  // of a triangle among its shell's
    for (std::uint32_t t = 0; t < shell.size(); ++t) {
        const std::uint32_t s = shell[t];
        facets.push_back(facet_of(surface, t));
        place[t] = static_cast<std::uint32_t>(members[s].size());
        members[s].push_back(t);
        area[s] += facets[t].area;
        centre[s] += facets[t].centre * facets[t].area;
    }
    for (std::uint32_t s = 0; s < shells; ++s)
        centre[s] = area[s] > 0 ? centre[s] / area[s] : facets[members[s][0]].centre;

    Regions result{std::vector<std::uint32_t>(shell.size()), count};
    if (count < shells) {
        const std::vector<std::uint32_t> group = group_shells(area, centre, count);
        for (std::size_t t = 0; t < shell.size(); ++t) result.region[t] = group[shell[t]];
        renumber(result);
        return result;
    }

    std::vector<std::uint32_t> sizes;
    for (const auto& m : members) sizes.push_back(static_cast<std::uint32_t>(m.size()));
    const std::vector<std::uint32_t> share = share_out(area, sizes, count);
    std::uint32_t first = 0;
    for (std::uint32_t s = 0; s < shells; ++s) {
        std::vector<Facet> own;
        Neighbours links;
        for (const std::uint32_t t : members[s]) {
            own.push_back(facets[t]);
            links.push_back({place[neighbours[t][0]], place[neighbours[t][1]], place[neighbours[t][2]]});
        }
        const std::vector<std::uint32_t> patch = split_patches(own, links, share[s]);
        for (std::size_t i = 0; i < patch.size(); ++i) result.region[members[s][i]] = first + patch[i];
        first += share[s];
    }
    renumber(result);
    return result;
}

std::vector<RegionProperties> region_properties(const Surface& surface, const Regions& regions) {
    if (regions.region.size() != surface.triangles.size()) throw BakeError("regions: they are not of this surface");
    std::vector<RegionProperties> result(regions.count);
    std::vector<Vec3d> plain(regions.count);
    std::vector<double> number(regions.count, 0.0);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        if (regions.region[t] >= regions.count) throw BakeError("regions: a triangle's region is out of range");
        const Facet f = facet_of(surface, t);
        RegionProperties& r = result[regions.region[t]];
        r.area += f.area;
        r.centre += f.centre * f.area;
        r.normal += f.normal * f.area;
        plain[regions.region[t]] += f.centre;
        number[regions.region[t]] += 1;
    }
    for (std::uint32_t i = 0; i < regions.count; ++i) {
        RegionProperties& r = result[i];
        if (r.area > 0) {
            r.centre = r.centre / r.area;
        } else if (number[i] > 0) {
            r.centre = plain[i] / number[i];
        }
        const double norm = length(r.normal);
        r.normal = norm > 1e-9 * r.area ? r.normal / norm : Vec3d{};
    }
    return result;
}

}  // namespace frm::bake
