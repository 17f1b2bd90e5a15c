#include "bake/regions/patches.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <tuple>

namespace frm::bake {

namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
constexpr double kPi = 3.14159265358979323846;

// Distance of a facet from a patch, in units in which the rim of a round patch of the wanted area is at 1
// (Cohen-Steiner et al., Variational Shape Approximation, with a position term for compactness).
constexpr double kNormalWeight = 2;

// Facets across a patch's facing direction (the rim of a blade) cost more than evening out areas can bring, so a patch
// of the rim never takes from front and back. Those that face the other way join it only when no other can reach them.
constexpr double kAcross = 0.25, kAcrossCost = 5;  // cosines to the patch's mean normal
constexpr double kOpposed = -0.25, kOpposedCost = 1000;

constexpr int kMostRounds = 60;
constexpr double kEvenOut = 0.35;  // how strongly a patch that is too large is pushed back in each round
constexpr double kMostOffset = 2;

constexpr std::uint32_t kWeighedSeeds = 32;  // seeds that are chosen for what they improve; later ones fill gaps
constexpr std::uint32_t kTrials = 16;

struct Proxy {
    Vec3d centre, normal;
    double area = 0;
};

struct Front {
    double distance = 0;
    std::uint32_t facet = 0, patch = 0;

    bool operator>(const Front& o) const {
        return std::tie(distance, facet, patch) > std::tie(o.distance, o.facet, o.patch);
    }
};

double cost_of_facing(double cosine) { return cosine >= kAcross ? 0 : cosine >= kOpposed ? kAcrossCost : kOpposedCost; }

class Clustering {
public:
    Clustering(const std::vector<Facet>& facets, const Neighbours& neighbours, std::uint32_t count)
        : facets_(facets), neighbours_(neighbours), count_(count), offset_(count, 0.0) {
        double area = 0;
        for (const Facet& f : facets) area += f.area;
        wanted_ = area / count;
        position_weight_ = wanted_ > 0 ? kPi / wanted_ : 0;
    }

    std::vector<std::uint32_t> run() {
        place_seeds();
        std::vector<std::uint32_t> best;
        double best_unevenness = HUGE_VAL;
        // Large meshes get fewer rounds: they are smooth enough to settle sooner.
        const int rounds =
            std::max(12, std::min(kMostRounds, static_cast<int>(6e6 / static_cast<double>(facets_.size()))));
        for (int round = 0; round < rounds; ++round) {
            grow();
            fit_proxies();
            const double uneven = unevenness();
            if (uneven < best_unevenness) {
                best_unevenness = uneven;
                best = patch_;
            }
            if (count_ > 1 && round % 3 == 2 && 3 * round < 2 * rounds) move_smallest();
            even_out();
            choose_seeds();
        }
        return best;
    }

private:
    double distance(std::uint32_t facet, const Proxy& proxy) const {
        const Facet& f = facets_[facet];
        const Vec3d d = f.centre - proxy.centre;
        const double alike = dot(f.normal, proxy.normal);
        return position_weight_ * dot(d, d) + kNormalWeight * 2 * (1 - alike) + cost_of_facing(alike);
    }

    void place_seeds() {
        std::vector<double> nearest(facets_.size(), kOpposedCost);  // distance to the nearest seed so far
        std::vector<char> taken(facets_.size(), 0);
        for (std::uint32_t s = 0; s < count_; ++s) {
            const std::uint32_t seed = s < kWeighedSeeds ? most_useful(nearest, taken) : farthest(nearest, taken);
            taken[seed] = 1;
            seeds_.push_back(seed);
            proxies_.push_back({facets_[seed].centre, facets_[seed].normal, 0});
            for (std::uint32_t t = 0; t < facets_.size(); ++t) {
                nearest[t] = std::min(nearest[t], distance(t, proxies_.back()));
            }
        }
    }

    static std::uint32_t farthest(const std::vector<double>& nearest, const std::vector<char>& taken) {
        std::uint32_t result = kNone;
        for (std::uint32_t t = 0; t < nearest.size(); ++t) {
            if (!taken[t] && (result == kNone || nearest[t] > nearest[result])) result = t;
        }
        return result;
    }

    // Of a few facets, spread over where the surface is badly covered, the one that covers most of it: a large side of
    // a plate before its thin ends, which are farther away.
    std::uint32_t most_useful(const std::vector<double>& nearest, const std::vector<char>& taken) const {
        double total = 0;
        for (std::size_t t = 0; t < facets_.size(); ++t) total += facets_[t].area * nearest[t];
        std::uint32_t best = kNone;
        double best_gain = -1, sum = 0;
        std::uint32_t trial = 0;
        for (std::uint32_t t = 0; t < facets_.size() && trial < kTrials; ++t) {
            sum += facets_[t].area * nearest[t];
            if (sum * kTrials < (trial + 0.5) * total) continue;
            while (trial < kTrials && sum * kTrials >= (trial + 0.5) * total) ++trial;
            if (taken[t]) continue;
            const Proxy proxy{facets_[t].centre, facets_[t].normal, 0};
            double gain = 0;
            for (std::uint32_t u = 0; u < facets_.size(); ++u) {
                gain += facets_[u].area * std::max(0.0, nearest[u] - distance(u, proxy));
            }
            if (gain > best_gain) {
                best_gain = gain;
                best = t;
            }
        }
        return best != kNone ? best : farthest(nearest, taken);
    }

    // All patches grow at once from their seeds over the facets' sides, nearest facet first: each stays connected.
    void grow() {
        patch_.assign(facets_.size(), kNone);
        std::priority_queue<Front, std::vector<Front>, std::greater<>> fronts;
        const auto spread = [&](std::uint32_t facet) {
            const std::uint32_t p = patch_[facet];
            for (const std::uint32_t n : neighbours_[facet]) {
                if (patch_[n] == kNone) fronts.push({distance(n, proxies_[p]) + offset_[p], n, p});
            }
        };
        for (std::uint32_t p = 0; p < count_; ++p) patch_[seeds_[p]] = p;
        for (const std::uint32_t seed : seeds_) spread(seed);
        while (!fronts.empty()) {
            const Front front = fronts.top();
            fronts.pop();
            if (patch_[front.facet] != kNone) continue;
            patch_[front.facet] = front.patch;
            spread(front.facet);
        }
    }

    void fit_proxies() {
        for (Proxy& p : proxies_) p = {};
        for (std::size_t t = 0; t < facets_.size(); ++t) {
            Proxy& p = proxies_[patch_[t]];
            p.centre += facets_[t].centre * facets_[t].area;
            p.normal += facets_[t].normal * facets_[t].area;
            p.area += facets_[t].area;
        }
        for (std::uint32_t i = 0; i < count_; ++i) {
            Proxy& p = proxies_[i];
            const double norm = length(p.normal);
            p.normal = norm > 1e-6 * p.area ? p.normal / norm : facets_[seeds_[i]].normal;
            p.centre = p.area > 0 ? p.centre / p.area : facets_[seeds_[i]].centre;
        }
    }

    // How far the areas are from equal, with facets on the wrong side of their patch counted as much worse.
    double unevenness() const {
        double sum = 0;
        for (std::size_t t = 0; t < facets_.size(); ++t) {
            if (dot(facets_[t].normal, proxies_[patch_[t]].normal) < kOpposed) sum += 10 * facets_[t].area / wanted_;
        }
        for (const Proxy& p : proxies_) {
            const double excess = p.area / wanted_ - 1;
            sum += excess * excess;
        }
        return sum;
    }

    void even_out() {
        for (std::uint32_t i = 0; i < count_; ++i) {
            offset_[i] += kEvenOut * std::clamp(proxies_[i].area / wanted_ - 1, -0.7, 0.7);
            offset_[i] = std::clamp(offset_[i], -kMostOffset, kMostOffset);
        }
    }

    void choose_seeds() {
        std::vector<double> nearest(count_, HUGE_VAL);
        for (std::uint32_t t = 0; t < facets_.size(); ++t) {
            const std::uint32_t p = patch_[t];
            if (p == kNone) continue;
            const double d = distance(t, proxies_[p]);
            if (d < nearest[p]) {
                nearest[p] = d;
                seeds_[p] = t;
            }
        }
    }

    // A patch wedged between others cannot grow by being pushed, and one that closes round a thin shaft cannot open:
    // the smallest patch goes where the worst has room for two. Rounds that this makes worse are not kept.
    void move_smallest() {
        std::vector<double> misfit(count_, 0.0);
        for (std::uint32_t t = 0; t < facets_.size(); ++t) {
            misfit[patch_[t]] += distance(t, proxies_[patch_[t]]) * facets_[t].area / wanted_;
        }
        std::uint32_t to = 0, largest = 0;
        for (std::uint32_t i = 1; i < count_; ++i) {
            if (misfit[i] > misfit[to]) to = i;
            if (proxies_[i].area > proxies_[largest].area) largest = i;
        }
        const bool opposed = misfit[to] > 0.05 * kOpposedCost;
        if (!opposed) to = largest;
        std::uint32_t from = to == 0 ? 1 : 0;
        for (std::uint32_t i = 0; i < count_; ++i) {
            if (i != to && proxies_[i].area < proxies_[from].area) from = i;
        }
        const bool uneven = proxies_[to].area > 1.15 * wanted_ && proxies_[from].area < 0.35 * wanted_;
        if (!opposed && !uneven) return;
        std::uint32_t outermost = kNone;
        double far = -1;
        for (std::uint32_t t = 0; t < facets_.size(); ++t) {
            if (patch_[t] != to || t == seeds_[to]) continue;
            const double d = distance(t, proxies_[to]);
            if (d > far) {
                far = d;
                outermost = t;
            }
        }
        if (outermost == kNone) return;
        for (std::uint32_t t = 0; t < facets_.size(); ++t) {
            if (patch_[t] == from) patch_[t] = kNone;
        }
        patch_[outermost] = from;
        proxies_[from] = {facets_[outermost].centre, facets_[outermost].normal, wanted_};
        proxies_[to].area = wanted_;
        offset_[from] = offset_[to];
    }

    const std::vector<Facet>& facets_;
    const Neighbours& neighbours_;
    std::uint32_t count_;
    double wanted_ = 0, position_weight_ = 0;
    std::vector<std::uint32_t> seeds_, patch_;
    std::vector<Proxy> proxies_;
    std::vector<double> offset_;  // added to the distance, so that areas become equal (a power diagram on the surface)
};

}  // namespace

Facet facet_of(const Surface& surface, std::size_t t) {
    const Vec3d a = surface.corner(t, 0), b = surface.corner(t, 1), c = surface.corner(t, 2);
    const Vec3d n = cross(b - a, c - a);
    const double norm = length(n);
    return {(a + b + c) / 3.0, norm > 0 ? n / norm : Vec3d{}, 0.5 * norm};
}

std::vector<std::uint32_t> split_patches(const std::vector<Facet>& facets, const Neighbours& neighbours,
                                         std::uint32_t count) {
    return Clustering(facets, neighbours, count).run();
}

}  // namespace frm::bake
