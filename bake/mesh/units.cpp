#include "bake/mesh/units.h"

#include <algorithm>
#include <cmath>

namespace frm::bake {
namespace {

struct Candidate {
    Unit unit;
    double doubt;  ///< factors of e by which it is less usual
};

// What is moved through water by hand or in a game is of the order of 1 m. Inches are rarer in exports than the others.
constexpr Candidate too_large[] = {{{"millimetres", 0.001}, 0}, {{"centimetres", 0.01}, 0}, {{"inches", 0.0254}, 0.8}};
constexpr Candidate too_small[] = {{{"millimetres, converted twice", 1000}, 0},
                                   {{"centimetres, converted twice", 100}, 0},
                                   {{"inches, converted twice", 1 / 0.0254}, 0.8}};

}  // namespace

std::vector<Unit> likely_units(double extent) {
    const auto doubt = [&](const Candidate& c) { return std::fabs(std::log(extent * c.unit.scale)) + c.doubt; };
    std::vector<Candidate> order;
    for (const Candidate& c : extent > 1 ? too_large : too_small) order.push_back(c);
    std::sort(order.begin(), order.end(), [&](const Candidate& a, const Candidate& b) { return doubt(a) < doubt(b); });
    std::vector<Unit> units;
    for (const Candidate& c : order)
        if (units.empty() || plausible_size(extent * c.unit.scale)) units.push_back(c.unit);
    return units;
}

}  // namespace frm::bake
