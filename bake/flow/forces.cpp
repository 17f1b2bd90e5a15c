#include "bake/flow/forces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "bake/flow/vectors.h"

namespace frm::bake::flow {
namespace {

constexpr std::size_t stretch_length = 256;
constexpr std::size_t ahead = 24;  // links whose populations are on their way from memory

double along_normal(const Link& link, const Direction& c) {
    return c.x * static_cast<double>(link.normal[0]) + c.y * static_cast<double>(link.normal[1]) +
           c.z * static_cast<double>(link.normal[2]);
}

/// In lanes of a fixed number, whatever the processor has.
FRM_FLOW_CLONES
double sum_of_products(const float* a, const float* b, std::size_t count) {
    constexpr std::size_t lanes = 8;
    double sums[lanes] = {};
    std::size_t n = 0;
    for (; n + lanes <= count; n += lanes) {
        for (std::size_t l = 0; l < lanes; ++l) {
            sums[l] += static_cast<double>(a[n + l]) * static_cast<double>(b[n + l]);
        }
    }
    for (std::size_t l = 0; n + l < count; ++l) {
        sums[l] += static_cast<double>(a[n + l]) * static_cast<double>(b[n + l]);
    }
    return ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7]));
}

}  // namespace

Wall::Wall(const std::vector<Link>& links, std::uint32_t regions, std::ptrdiff_t apart)
    : back_(links.size()), exchange_(links.size()), area_(regions, 0.0) {
    places_.reserve(links.size());
    weights_.reserve(links.size());
    for (std::vector<float>& share : share_) share.reserve(links.size());
    for (std::size_t n = 0; n < links.size(); ++n) {
        const Link& link = links[n];
        if (stretches_.empty() || stretches_.back().region != link.region ||
            n - stretches_.back().first == stretch_length) {
            stretches_.push_back({n, n, link.region, {}});
        }
        stretches_.back().last = n + 1;
        const auto place = [&](int direction, std::uint64_t cell) {
            return direction * apart + static_cast<std::ptrdiff_t>(cell);
        };
        const int i = link.direction;
        places_.push_back(
            {place(i, link.cell), place(opposite(i), link.cell), place(i, link.far), place(opposite(i), link.into)});
        weights_.push_back({link.weight[0], link.weight[1], link.weight[2], link.wall});

        // Momentum exchange (Ladd 1994, J. Fluid Mech. 271): what went in and what came back, both along i. Pressure
        // acts along the normal of the triangle the link hits, friction in its plane (the paper's Fig. 4b). A uniform
        // pressure on a flat wall leaves no friction, because the links of a plane sum to its area vector. Measured on a
        // sphere at Re 100, friction's share of the drag against 0.53 in the literature: 0.54 with 16 cells and 0.53
        // with 24. Summing the density of the cells beside the wall over the same links instead, and calling the rest
        // friction, gave 0.41 with 10 cells and 0.50 with 24.
        const Direction& c = directions[link.direction];
        const double along = along_normal(link, c);
        const double force[3] = {static_cast<double>(c.x), static_cast<double>(c.y), static_cast<double>(c.z)};
        for (std::size_t k = 0; k < 3; ++k) {
            const std::size_t a = (k + 1) % 3, b = (k + 2) % 3;
            share_[k].push_back(static_cast<float>(force[k]));
            share_[3 + k].push_back(static_cast<float>(along * static_cast<double>(link.normal[k])));
            share_[6 + k].push_back(static_cast<float>(static_cast<double>(link.arm[a]) * force[b] -
                                                       static_cast<double>(link.arm[b]) * force[a]));
        }
        // The weights' second moment is 1/3 and a wall cuts half of the directions: 6 w c sums to the area vector.
        area_[link.region] -= 6 * static_cast<double>(weight(i)) * along;
    }
}

void Wall::gather(const Populations& from, float motion, std::size_t stretch) {
    Stretch& s = stretches_[stretch];
    const float* const f = from.at(0);
    for (std::size_t n = s.first; n < s.last; ++n) {
        const Places& at = places_[n];
        const Weights& w = weights_[n];
        if (n + ahead < places_.size()) {
            const Places& next = places_[n + ahead];
            ask_for(f + next.out);
            ask_for(f + next.in);
            ask_for(f + next.far);
        }
        const float out = f[at.out];
        back_[n] = w.out * out + w.in * f[at.in] + w.far * f[at.far] + motion * w.wall;
        exchange_[n] = out + back_[n];
    }
    double* const results[parts] = {&s.load.force[0],    &s.load.force[1],    &s.load.force[2],
                                    &s.load.pressure[0], &s.load.pressure[1], &s.load.pressure[2],
                                    &s.load.torque[0],   &s.load.torque[1],   &s.load.torque[2]};
    for (std::size_t p = 0; p < parts; ++p) {
        *results[p] = sum_of_products(exchange_.data() + s.first, share_[p].data() + s.first, s.last - s.first);
    }
}

void Wall::scatter(Populations& from, std::size_t stretch) const {
    const Stretch& s = stretches_[stretch];
    float* const f = from.at(0);
    for (std::size_t n = s.first; n < s.last; ++n) f[places_[n].into] = back_[n];
}

void Wall::sum(std::vector<Load>& regions) const {
    for (Load& load : regions) load = {};
    for (const Stretch& s : stretches_) regions[s.region].add(s.load, 1);
}

void Wall::limit_friction(std::vector<Load>& regions, double speed, double reynolds) const {
    const double coefficient = 4 / std::sqrt(reynolds) + 10 / reynolds;
    for (std::size_t r = 0; r < regions.size(); ++r) {
        Load& load = regions[r];
        const Vec3d friction{load.force[0] - load.pressure[0], load.force[1] - load.pressure[1],
                             load.force[2] - load.pressure[2]};
        const double size = length(friction), most = std::max(area_[r], 0.0) * coefficient * 0.5 * speed * speed;
        if (size <= most) continue;
        const double surplus = 1 - most / size;
        for (int i = 0; i < 3; ++i) load.pressure[i] += surplus * friction[i];
    }
}

}  // namespace frm::bake::flow
