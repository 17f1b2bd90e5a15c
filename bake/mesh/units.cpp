#include "bake/mesh/units.h"

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

Unit likely_unit(double extent) {
    Unit best{};
    double least = 1e300;
    for (const Candidate& c : extent > 1 ? too_large : too_small) {
        const double doubt = std::fabs(std::log(extent * c.unit.scale)) + c.doubt;
        if (doubt < least) least = doubt, best = c.unit;
    }
    return best;
}

}  // namespace frm::bake
