// haptic_stability NAME=MAP.frm ...: where the loop of hand, device, servo, map and waves is stable, as JSON lines. For
// each map, hand and rate the force is scaled up until a limit cycle appears, with and without the passivity controller.
// scripts/haptic-stability draws them.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <map>
#include <string>

#include "core/map/codec.h"
#include "tests/support/haptic_loop.h"

namespace {

using namespace frm;
using namespace frm::test;

struct NamedHand {
    const char* name;
    Hand hand;
};
constexpr NamedHand hands[] = {{"light", {0.1, 1, 50, 2e-4, 2e-3, 0.2}}, {"firm", {0.3, 8, 400, 5e-4, 0.02, 2}}};
constexpr double rates[] = {100, 200, 500, 1000, 2000, 5000};

std::shared_ptr<const Map> read(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
    auto map = std::make_shared<Map>();
    decode_map(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size(), *map);
    return map;
}

HapticCase stroke(const std::shared_ptr<const Map>& map, const Hand& hand, double rate) {
    HapticCase c;
    c.map = map;
    c.rate = rate;
    c.device.hand = hand;
    c.device.delay = 1;
    c.device.max_force = 200;
    c.speed = 0.5;
    // As heavy as the water that it displaces: what is scaled up is drag, not a lift that throws it out.
    {
        World world = world_of(WorldDef());
        Body& body = world.create_body(body_of(map, {0, -0.5, -0.2}));
        world.tick(0.001f);
        c.mass = body.forces.total.force.z / world.def().fluid.gravity;
    }
    c.start = {0, -0.5, -0.2};
    c.cells = 100;
    return c;
}

/// Residual motion that is the loop's: more than the same stroke has where the loop is as good as it gets.
bool swings(const HapticResult& r, const HapticResult& best) {
    return r.faults != 0 || r.amplitude > 2 * std::min(best.amplitude, 0.001) + 2e-4;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) return std::fprintf(stderr, "usage: haptic_stability NAME=MAP.frm ...\n"), 2;
    for (int i = 1; i < argc; ++i) {
        const std::string argument = argv[i];
        const std::size_t equals = argument.find('=');
        const std::string name = argument.substr(0, equals);
        const auto map = read(argument.substr(equals + 1));
        for (const NamedHand& hand : hands) {
            std::map<double, HapticResult> best;  // by scale: the same for all rates
            const HapticResult unit = run_haptic_case(ideal(stroke(map, hand.hand, 5000)));
            for (const double rate : rates)
                for (const bool passivity : {false, true}) {
                    // What is stable is followed up by steps of half an octave to the first that is not.
                    double stable = 0, left = 0;
                    HapticResult at;
                    bool found = false;
                    for (double scale = 1.0 / 16; scale < 65; scale *= std::sqrt(2.0)) {
                        HapticCase c = stroke(map, hand.hand, rate);
                        c.force_scale = static_cast<float>(scale);
                        c.passivity = passivity;
                        const HapticResult r = run_haptic_case(c);
                        if (!best.count(scale)) best[scale] = run_haptic_case(ideal(c));
                        if (swings(r, best[scale])) {
                            found = true;
                            left = r.amplitude;
                            break;
                        }
                        stable = scale;
                        at = r;
                    }
                    std::printf(
                        "{\"map\":\"%s\",\"hand\":\"%s\",\"mass\":%g,\"damping\":%g,\"stiffness\":%g,\"rate\":%g,"
                        "\"passivity\":%d,\"speed\":0.5,\"unit_force\":%.6g,\"scale\":%.6g,\"ended\":%d,"
                        "\"beyond\":%.6g,\"force\":%.6g,\"gain\":%.4g}\n",
                        name.c_str(), hand.name, hand.hand.mass, hand.hand.damping, hand.hand.stiffness, rate,
                        passivity, unit.mean_force, stable, found, left, at.mean_force, at.quick_gain);
                    std::fflush(stdout);
                }
        }
    }
    return 0;
}
